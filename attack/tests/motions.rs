//! Random motions, stopped and resumed.
#![cfg(unix)]

use emmy_attack::motions::resumes_in_every_bit;

/// Checks the motions of some seeds, or of the seed in `EMMY_DRAW`.
fn draw(seeds: std::ops::Range<u64>) {
    let one = std::env::var("EMMY_DRAW").ok().map(|seed| seed.parse().expect("a seed in EMMY_DRAW"));
    let seeds = one.map_or(seeds, |seed: u64| seed..seed + 1);
    let faults: Vec<String> = seeds.filter_map(|seed| resumes_in_every_bit(seed).err()).collect();
    assert!(
        faults.is_empty(),
        "{} draws (repeat one with EMMY_DRAW=SEED):\n{}",
        faults.len(),
        faults.join("\n\n")
    );
}

#[test]
fn ten_random_motions_are_resumed_in_every_bit() {
    draw(0..10);
}

#[test]
#[ignore = "half a minute; `.ci/run` and `just validate` run it"]
fn two_hundred_random_motions_are_resumed_in_every_bit() {
    draw(1000..1200);
}
