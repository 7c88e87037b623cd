//! Resources used by this process.

use std::time::Duration;

/// CPU time of the process so far, all threads together.
#[cfg(unix)]
pub(crate) fn cpu_time() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

/// Wall time since the first call: other systems have no portable clock of CPU time, and on a quiet machine both are
/// nearly equal for a run with one thread.
#[cfg(not(unix))]
pub fn cpu_time() -> Duration {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed()
}

/// Largest resident memory so far \[MB = 2^20 bytes\], if the system reports it (Linux).
pub(crate) fn peak_megabytes() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: f64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kilobytes / 1024.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_takes_cpu_time() {
        let start = cpu_time();
        let mut sum = 0.0;
        while cpu_time() < start + Duration::from_millis(2) {
            sum += f64::sqrt(sum + 1.0);
        }
        assert!(sum > 0.0);
    }

    #[test]
    fn a_process_has_some_memory() {
        assert!(peak_megabytes().is_none_or(|megabytes| megabytes > 0.1));
    }
}
