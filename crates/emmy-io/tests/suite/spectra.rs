//! Spectra against closed forms, and against SciPy 1.17 with the same samples.

use std::f64::consts::{PI, TAU};

use emmy_io::spectra::{
    Detrend, Segments, Window, amplitudes, frequency_response, power_spectral_density, shock_response,
};

/// Distance of the samples.
const STEP: f64 = 0.02;

/// Samples that look random, from whole numbers.
fn samples() -> (Vec<f64>, Vec<f64>) {
    let x: Vec<f64> = (0..50).map(|k| f64::from((7 * k * k + 3 * k) % 31) / 31.0).collect();
    let of = |(k, x): (i32, &f64)| f64::from((5 * k * k + 11 * k) % 29) / 29.0 + 0.5 * x;
    let y = (0..50).zip(&x).map(of).collect();
    (x, y)
}

/// Compares numbers relative to the largest one; SciPy transforms in another order.
fn close(found: &[f64], expected: &[f64]) {
    let scale = expected.iter().fold(0.0, |scale: f64, x| scale.max(x.abs()));
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-13 * scale, "{found} {expected}");
    }
}

const HANN: &[f64] = &[
    0.0005153948577473895,
    0.0015810237107382614,
    0.0019619251649836177,
    0.004972558988618292,
    0.004202715775459393,
    0.0022189464078247838,
    0.0011622272488250348,
    0.00113060662262786,
    0.0005386134457777379,
];
const FLAT_TOP: &[f64] = &[
    0.00042027103396856055,
    0.0018758272867118102,
    0.004142844324870281,
    0.005732803698043075,
    0.00546018358247901,
    0.00338977881159785,
    0.0013417279934236992,
    0.00037162910213173737,
];
const BLACKMAN: &[f64] = &[
    0.042694638171457494,
    0.03252038991276426,
    0.0017403535997588756,
    0.0034932946945449225,
    0.005365890434070179,
    0.004192029244994088,
    0.002827746589462705,
    0.0013547546041333134,
    0.0008228702636105714,
    0.001293883782661827,
    0.0005031388292899574,
];
/// The first numbers.
const BOXCAR: &[f64] = &[
    0.0,
    0.001646881536935128,
    0.0077505588401449495,
    0.0014112331000381544,
    9.340015916186996e-05,
    0.004888735835309941,
    0.000644855835977672,
    0.001101514492840455,
];

/// `scipy.signal.welch(x, 50, window, nperseg, noverlap, detrend)`.
#[test]
fn power_spectral_densities_are_those_of_scipy() {
    let (x, _) = samples();
    for (window, length, overlap, detrend, expected) in [
        (Window::Hann, 16, None, Detrend::Constant, HANN),
        (Window::FlatTop, 15, Some(4), Detrend::Linear, FLAT_TOP),
        (Window::Blackman, 20, Some(10), Detrend::None, BLACKMAN),
        (Window::Boxcar, 50, Some(0), Detrend::Constant, BOXCAR),
    ] {
        let segments = Segments { window, length, overlap, detrend };
        let (frequencies, density) = power_spectral_density(&x, STEP, &segments).unwrap();
        assert_eq!((frequencies.len(), density.len()), (length / 2 + 1, length / 2 + 1));
        assert!((frequencies[1] * length as f64 * STEP - 1.0).abs() < 1e-15);
        close(&density, expected);
    }
}

const GAIN_REAL: &[f64] = &[
    -0.27978897881096226,
    0.34736442069164264,
    0.6919834841133725,
    0.6683199511626201,
    0.15879085265464205,
    0.7778283091174849,
    0.7876002196448247,
    0.4775464291462274,
    0.5961691562977931,
];
const GAIN_IMAGINARY: &[f64] = &[
    0.0,
    -0.7180538471113254,
    0.054222863867203756,
    0.1714674199561224,
    0.207092989783195,
    -0.056682568517099,
    -0.24556277578340927,
    -0.07767283439467829,
    0.0,
];
const COHERENCE: &[f64] = &[
    0.1513163280140006,
    0.44144986287718546,
    0.6784379203495395,
    0.5300204906200232,
    0.0734525020496573,
    0.34358742436142675,
    0.2287851897411113,
    0.1998472677115889,
    0.3505212592640404,
];

/// `scipy.signal.csd(x, y)/welch(x)`, and `coherence(x, y)`.
#[test]
fn frequency_response_and_coherence_are_those_of_scipy() {
    let (x, y) = samples();
    let segments = Segments { length: 16, ..Segments::default() };
    let found = frequency_response(&x, &y, STEP, &segments).unwrap();
    close(&found.gain.iter().map(|gain| gain[0]).collect::<Vec<_>>(), GAIN_REAL);
    close(&found.gain.iter().map(|gain| gain[1]).collect::<Vec<_>>(), GAIN_IMAGINARY);
    close(&found.coherence, COHERENCE);
}

/// A delay of a quarter of a period turns the phase by -pi/2, and a factor is the amplitude.
#[test]
fn a_delayed_sine_has_its_amplitude_and_phase() {
    let sine = |i: i32, delay: f64| (TAU * (f64::from(i) / 16.0 - delay)).sin();
    let wave = |delay: f64| -> Vec<f64> { (0..256).map(|i| sine(i, delay)).collect() };
    let late: Vec<f64> = wave(0.25).iter().map(|y| 3.0 * y).collect();
    let segments = Segments { length: 64, ..Segments::default() };
    let found = frequency_response(&wave(0.0), &late, STEP, &segments).unwrap();
    let at = 4;
    assert!((found.frequencies[at] - 1.0 / (16.0 * STEP)).abs() < 1e-14);
    assert!((found.amplitudes()[at] - 3.0).abs() < 1e-12 && (found.phases()[at] + 0.5 * PI).abs() < 1e-12);
}

/// The density integrates to the mean square (Parseval), and the amplitude of a sine between two frequencies of the
/// transform is within 0.12 % with a flat-top window.
#[test]
fn densities_add_up_and_flat_tops_keep_amplitudes() {
    let (x, _) = samples();
    let segments = Segments { window: Window::Boxcar, length: 50, overlap: None, detrend: Detrend::None };
    let (frequencies, density) = power_spectral_density(&x, STEP, &segments).unwrap();
    let power: f64 = density.iter().sum::<f64>() * frequencies[1];
    let square = x.iter().map(|x| x * x).sum::<f64>() / 50.0;
    assert!((power / square - 1.0).abs() < 1e-14);

    let wave: Vec<f64> = (0..200).map(|i| 3.0 * (TAU * 10.5 * f64::from(i) / 200.0).sin()).collect();
    let amplitude = |window| {
        let segments = Segments { window, length: 200, overlap: None, detrend: Detrend::Constant };
        amplitudes(&wave, STEP, &segments).unwrap().1[10]
    };
    // sum(w exp(-i pi k/n))/sum(w), as NumPy has it.
    assert!((amplitude(Window::FlatTop) / 3.0 - 0.998_875).abs() < 1e-4);
    // The scalloping loss of a Hann window, 8/(3 pi).
    assert!((amplitude(Window::Hann) / 3.0 - 8.0 / (3.0 * PI)).abs() < 1e-3);
}

/// `scipy.signal.lfilter` with the coefficients of ISO 18431-4 for the absolute acceleration and the relative
/// displacement: positive and negative extremes of each, with zeros behind the record.
#[test]
fn shock_responses_are_those_of_the_ramp_invariant_filters() {
    let (x, _) = samples();
    let acceleration: Vec<f64> = x.iter().map(|x| x - 0.5).collect();
    for (f, q, expected) in [
        (0.5, 10.0, [0.14429201406521425, 0.15769501941404535, 0.01588837799010631, 0.014541093529990503]),
        (2.0, 10.0, [0.5574285816847703, 0.6813373256079817, 0.004323669679580106, 0.0035051546755889996]),
        (5.0, 10.0, [0.7441548228544861, 0.8458075750903313, 0.0008582546072758773, 0.0007634704028564797]),
        (3.0, 0.8, [0.23420036427845947, 0.4418462169580842, 0.0008945706902282773, 0.0003218795498955701]),
    ] {
        let found = shock_response(&acceleration, STEP, &[f], q).unwrap()[0];
        let (a, z) = (found.acceleration, found.displacement);
        close(&[a.positive, a.negative], &expected[..2]);
        // The coefficients of the filter for the displacement cancel: 1e-16/(omega h)^3.
        for (found, expected) in [(z.positive, expected[2]), (z.negative, expected[3])] {
            assert!((found / expected - 1.0).abs() < 1e-10, "{found} {expected}");
        }
    }
}

/// A half sine of amplitude 1 over the time tau excites an undamped oscillator. With beta = pi/(omega tau) < 1 the
/// largest absolute acceleration in the pulse is sin(2 pi beta/(1 + beta))/(1 - beta), at 2 pi/(omega + pi/tau); behind
/// it is the amplitude 2 beta/(1 - beta^2) |cos(omega tau/2)|, also with the opposite sign (Duhamel's integral).
#[test]
fn the_shock_response_of_a_half_sine_is_that_of_duhamel() {
    let n = 20_000;
    let step = 0.1 / f64::from(n);
    let pulse: Vec<f64> = (0..=n).map(|i| (PI * f64::from(i) / f64::from(n)).sin()).collect();
    for beta in [1.0 / 3.0, 0.4, 0.6] {
        let omega = PI / (beta * 0.1);
        let found = shock_response(&pulse, step, &[omega / TAU], 1e9).unwrap()[0];
        let inside = (TAU * beta / (1.0 + beta)).sin() / (1.0 - beta);
        let behind = 2.0 * beta / (1.0 - beta * beta) * (0.05 * omega).cos().abs();
        let a = found.acceleration;
        // Sampled peaks are too low by up to (omega h)^2/8, and those behind by 5e-8.
        assert!((a.positive - inside.max(behind)).abs() < 1e-6 && a.maximax() == a.positive);
        assert!((a.negative - behind).abs() < 1e-6, "{beta}: {} {behind}", a.negative);
        assert!((found.displacement.negative * omega * omega - a.positive).abs() < 1e-6);
    }
}

/// A sudden speed V of the base: a slow oscillator moves by V/omega exp(-phi/tan(phi)) relative to it, with
/// cos(phi) = 1/(2 Q). Here omega h is 1e-7, where the coefficients of the filter have no digits.
#[test]
fn slow_oscillators_keep_their_digits() {
    let (step, f, q) = (1e-5, 1e-7 / 1e-5 / TAU, 10.0);
    let found = shock_response(&[2.0; 10], step, &[f], q).unwrap()[0];
    // Ten samples, with a ramp before and behind them.
    let speed = 10.0 * step * 2.0;
    let phi = f64::acos(0.5 / q);
    let expected = speed / (TAU * f) * (-phi / phi.tan()).exp();
    assert!((found.displacement.negative / expected - 1.0).abs() < 2e-6, "{found:?} {expected}");
}

#[test]
fn impossible_spectra_are_rejected() {
    let few = [1.0, 2.0, 3.0, 4.0];
    let segments = |length, overlap| Segments { length, overlap: Some(overlap), ..Segments::default() };
    let message =
        |segments: &Segments, step| power_spectral_density(&few, step, segments).unwrap_err().to_string();
    assert!(message(&segments(4, 4), 0.1).contains("cannot overlap by 4"));
    assert!(message(&segments(4, 1), -0.1).contains("must be a positive number"));
    assert!(power_spectral_density(&[], 0.1, &segments(4, 1)).is_err());
    assert!(frequency_response(&few, &few[..3], 0.1, &segments(4, 1)).is_err());
    assert!(
        shock_response(&few, 0.1, &[0.0], 10.0).is_err() && shock_response(&[], 0.1, &[1.0], 10.0).is_err()
    );
}
