//! The calls of the C shim. The only unsafe code of the crate beside `petsc`.

#![allow(unsafe_code)]

use std::ffi::{c_char, c_int};

use emmy::team::Parcel;

unsafe extern "C" {
    fn emmy_mpi_start(rank: *mut c_int, size: *mut c_int, is_ours: *mut c_int) -> c_int;
    fn emmy_mpi_end() -> c_int;
    fn emmy_mpi_group(rank: c_int, size: c_int) -> c_int;
    fn emmy_mpi_gather(own: *const f64, n: c_int, all: *mut f64) -> c_int;
    fn emmy_mpi_gather_group(own: *const f64, n: c_int, all: *mut f64) -> c_int;
    fn emmy_mpi_gather_leaders(own: *const f64, n: c_int, all: *mut f64) -> c_int;
    fn emmy_mpi_tell_group(numbers: *mut f64, n: c_int) -> c_int;
    fn emmy_mpi_exchange(
        n: c_int,
        ranks: *const c_int,
        outgoing: *const *const f64,
        n_out: *const c_int,
        incoming: *const *mut f64,
        n_in: *const c_int,
    ) -> c_int;
    fn emmy_mpi_text(code: c_int, text: *mut c_char, length: *mut c_int) -> c_int;
    fn emmy_mpi_abort(code: c_int);
}

/// Starts MPI; returns the number of this rank, the number of ranks, and whether MPI must be ended here.
pub(crate) fn start() -> Result<(usize, usize, bool), String> {
    let (mut rank, mut size, mut is_ours) = (0, 0, 0);
    // SAFETY: each is valid for a number.
    checked(unsafe { emmy_mpi_start(&mut rank, &mut size, &mut is_ours) })?;
    Ok((rank as usize, size as usize, is_ours == 1))
}

/// Ends MPI.
pub(crate) fn end() -> Result<(), String> {
    // SAFETY: no arguments.
    checked(unsafe { emmy_mpi_end() })
}

/// Divides the ranks into groups of a size.
pub(crate) fn divide(rank: usize, size: usize) -> Result<(), String> {
    // SAFETY: numbers.
    checked(unsafe { emmy_mpi_group(count(rank)?, count(size)?) })
}

/// Gathers the numbers of a group on its first rank, `all: [size of the group][own.len()]`.
pub(crate) fn gather_group(own: &[f64], all: &mut [f64], size: usize) -> Result<(), String> {
    assert_eq!(all.len(), own.len() * size);
    // SAFETY: `own` has n numbers, `all` n for each rank of the group.
    checked(unsafe { emmy_mpi_gather_group(own.as_ptr(), count(own.len())?, all.as_mut_ptr()) })
}

/// Gathers the numbers of the first ranks of all groups on these ranks, `all: [number of groups][own.len()]`.
pub(crate) fn gather_leaders(own: &[f64], all: &mut [f64], n_groups: usize) -> Result<(), String> {
    assert_eq!(all.len(), own.len() * n_groups);
    // SAFETY: `own` has n numbers, `all` n for each group; the caller is the first rank of one.
    checked(unsafe { emmy_mpi_gather_leaders(own.as_ptr(), count(own.len())?, all.as_mut_ptr()) })
}

/// Gives the numbers of the first rank of each group to the others of the group.
pub(crate) fn tell_group(numbers: &mut [f64]) -> Result<(), String> {
    // SAFETY: n numbers.
    checked(unsafe { emmy_mpi_tell_group(numbers.as_mut_ptr(), count(numbers.len())?) })
}

/// Gathers the numbers of all ranks, `all: [size][own.len()]`.
pub(crate) fn gather(own: &[f64], all: &mut [f64], size: usize) -> Result<(), String> {
    assert_eq!(all.len(), own.len() * size);
    // SAFETY: `own` has n numbers, `all` n for each rank.
    checked(unsafe { emmy_mpi_gather(own.as_ptr(), count(own.len())?, all.as_mut_ptr()) })
}

/// Exchanges parcels; the lengths of both sides are set.
pub(crate) fn exchange(parcels: &mut [Parcel]) -> Result<(), String> {
    let counts = |of: fn(&Parcel) -> usize| -> Result<Vec<c_int>, String> {
        parcels.iter().map(|parcel| count(of(parcel))).collect()
    };
    let ranks = counts(|parcel| parcel.rank)?;
    let n_out = counts(|parcel| parcel.outgoing.len())?;
    let n_in = counts(|parcel| parcel.incoming.len())?;
    let outgoing: Vec<*const f64> = parcels.iter().map(|parcel| parcel.outgoing.as_ptr()).collect();
    let incoming: Vec<*mut f64> = parcels.iter_mut().map(|parcel| parcel.incoming.as_mut_ptr()).collect();
    // SAFETY: the lists have n entries, each pointer is valid for the number of entries beside it, and the call returns
    // after all messages have arrived.
    checked(unsafe {
        emmy_mpi_exchange(
            count(ranks.len())?,
            ranks.as_ptr(),
            outgoing.as_ptr(),
            n_out.as_ptr(),
            incoming.as_ptr(),
            n_in.as_ptr(),
        )
    })
}

/// Ends all ranks with an exit code.
pub(crate) fn abort(code: i32) -> ! {
    // SAFETY: a number.
    unsafe { emmy_mpi_abort(code) };
    std::process::exit(code)
}

fn count(n: usize) -> Result<c_int, String> {
    c_int::try_from(n).map_err(|_| format!("a message of {n} numbers is too long for MPI"))
}

fn checked(code: c_int) -> Result<(), String> {
    match code {
        0 => return Ok(()),
        -1 => return Err("MPI has ended; a process starts it once".to_string()),
        -2 => return Err("this MPI does not allow a program with threads".to_string()),
        _ => {}
    }
    let mut text = [0u8; 512];
    let mut length = 0;
    // SAFETY: `text` has the length that the shim asks for.
    let known = unsafe { emmy_mpi_text(code, text.as_mut_ptr().cast(), &mut length) } == 0;
    let text = text.get(..length as usize).filter(|_| known).unwrap_or_default();
    Err(format!("MPI failed with code {code}: {}", String::from_utf8_lossy(text)))
}
