//! Tests of time functions.

use super::*;

#[test]
fn jumps_have_a_value_before_and_after() {
    let table = TimeFunction::new(vec![(0.0, 1.0), (0.0, 5.0), (2.0, 3.0), (2.0, 0.0)]).unwrap();
    let values = [-1.0, 0.0, 1.0, 2.0, 3.0].map(|t| [table.value_before(t), table.value(t)]);
    assert_eq!(values, [[1.0, 1.0], [1.0, 5.0], [4.0, 4.0], [3.0, 0.0], [0.0, 0.0]]);
}

#[test]
fn averages_are_exact_across_kinks_and_jumps() {
    // f = 0 before t = 1, jumps to 2, falls to 0 at t = 2. Step from 0.5 to 3 (h = 2.5).
    let time_function = TimeFunction::new(vec![(1.0, 0.0), (1.0, 2.0), (2.0, 0.0)]).unwrap();
    let rule = Rule::discrete_gradient(2);
    let b = rule.weights();
    let c = rule.nodes();
    let mut averages = [0.0; 2];
    time_function.averages(0.5, 2.5, &rule, &mut averages).unwrap();
    // sum_i b_i avg_i = integral f / h = 1 / 2.5; sum_i b_i c_i avg_i = integral alpha f: by hand 1/h int (t -
    // 0.5)/h f dt
    let zeroth: f64 = (0..2).map(|i| b[i] * averages[i]).sum();
    let first: f64 = (0..2).map(|i| b[i] * c[i] * averages[i]).sum();
    // integral over [1, 2] of (t - 0.5) 2 (2 - t) dt = 5/6
    assert!((zeroth - 0.4).abs() < 1e-15 && (first - 5.0 / 6.0 / 6.25).abs() < 1e-15);
}

#[test]
fn averages_of_a_smooth_function_match_its_integrals() {
    // f = exp(3 t) on a step of 0.1: sum_i b_i avg_i = (e^0.3 - 1) / 0.3 for any degree.
    let time_function = TimeFunction::smooth("exp(3 t)", |t| [1.0, 3.0, 9.0].map(|f| f * (3.0 * t).exp()));
    for degree in 1..=4 {
        let rule = Rule::discrete_gradient(degree);
        let mut averages = [0.0; 4];
        time_function.averages(0.0, 0.1, &rule, &mut averages[..degree]).unwrap();
        let sum: f64 = (0..degree).map(|i| rule.weights()[i] * averages[i]).sum();
        assert!((sum - (0.3f64.exp() - 1.0) / 0.3).abs() < 1e-15, "{degree}");
    }
}

#[test]
fn rates_and_kinks_match_the_table() {
    let time_function = TimeFunction::new(vec![(0.0, 0.0), (0.5, 1.0), (1.0, 0.0), (1.0, 2.0)]).unwrap();
    assert_eq!([-1.0, 0.0, 0.5, 0.7, 1.0].map(|t| time_function.rate(t)), [0.0, 2.0, -2.0, -2.0, 0.0]);
    assert_eq!(
        [-1.0, 0.0, 0.6, 1.0].map(|t| time_function.next_kink(t)),
        [Some(0.0), Some(0.5), Some(1.0), None]
    );
    assert_eq!((time_function.first_jump(), TimeFunction::constant().first_jump()), (Some(1.0), None));
    assert!(TimeFunction::smooth("t", |t| [t, 1.0, 0.0]) == TimeFunction::smooth("t", |_| [0.0; 3]));
}

#[test]
fn steps_end_only_where_a_measured_table_turns() {
    // A hat of 1000 rows with noise of 0.2 % turns at its start, top and end, and jumps at t = 20.
    let hat = |t: f64| (1.0 - (t - 5.0).abs() / 5.0).max(0.0);
    let noise = |i: u32| 0.002 * (f64::from(i * 7919 % 1000) / 1000.0 - 0.5);
    let mut entries: Vec<Entry> =
        (0..=1000).map(|i| (0.015 * f64::from(i), hat(0.015 * f64::from(i)) + noise(i))).collect();
    entries.extend([(20.0, 0.0), (20.0, 0.5), (30.0, 0.5)]);
    let table = TimeFunction::measured(entries.clone()).unwrap();
    let mut corners = vec![-1.0];
    while let Some(corner) = table.next_corner(corners[corners.len() - 1]) {
        corners.push(corner);
    }
    assert!(corners.len() < 20 && corners.contains(&20.0), "{corners:?}");
    for turn in [0.0, 5.0, 10.0] {
        assert!(corners.iter().any(|corner| (corner - turn).abs() < 0.2), "{turn}: {corners:?}");
    }
    // Between corners the table is almost a line.
    for (time, factor) in entries.iter().filter(|entry| entry.0 < 20.0) {
        let next = corners.partition_point(|corner| corner <= time);
        let [a, b] = [corners[next - 1].max(0.0), corners[next]];
        let line = table.value(a) + (table.value(b) - table.value(a)) * (time - a) / (b - a);
        assert!(b == 20.0 || (line - factor).abs() <= 0.02, "{time} {line} {factor}");
    }
    assert_eq!(table.next_kink(0.001), Some(0.015));
    assert_eq!(TimeFunction::new(entries).unwrap().next_corner(0.001), Some(0.015));
}

#[test]
fn times_must_go_forward() {
    assert!(matches!(
        TimeFunction::new(vec![(1.0, 0.0), (0.5, 0.0)]),
        Err(Error::TimeFunction { entry: 1, .. })
    ));
    assert!(TimeFunction::new(vec![]).is_err());
    assert!(TimeFunction::new(vec![(0.0, f64::NAN)]).is_err());
}

#[test]
fn a_function_of_times_has_the_bits_of_a_function_of_one_time_and_is_called_once_a_step() {
    use std::sync::atomic::{AtomicUsize, Ordering};
    let calls = Arc::new(AtomicUsize::new(0));
    let count = calls.clone();
    let law = |t: f64| (7.0 * t).sin() * (-t).exp();
    let at_once = TimeFunction::of_times("damped", move |times, values| {
        count.fetch_add(1, Ordering::Relaxed);
        values.iter_mut().zip(times).for_each(|(value, &time)| *value = law(time));
    });
    let one_by_one = TimeFunction::smooth("damped", move |t| [law(t), f64::NAN, f64::NAN]);
    for degree in 1..=8 {
        let rule = Rule::discrete_gradient(degree);
        let mut averages = [[0.0; 8]; 2];
        at_once.averages(0.3, 0.2, &rule, &mut averages[0][..degree]).unwrap();
        one_by_one.averages(0.3, 0.2, &rule, &mut averages[1][..degree]).unwrap();
        assert_eq!(averages[0], averages[1]);
        assert_eq!(calls.swap(0, Ordering::Relaxed), 1, "degree {degree}");
    }
}

#[test]
fn a_value_that_is_not_finite_has_its_time() {
    let rule = Rule::discrete_gradient(2);
    let mut averages = [0.0; 2];
    let pole = TimeFunction::of_times("pole", |times, values| {
        values
            .iter_mut()
            .zip(times)
            .for_each(|(value, &t)| *value = if t > 0.5 { f64::INFINITY } else { 1.0 });
    });
    assert_eq!(pole.averages(0.0, 0.5, &rule, &mut averages), Ok(()));
    let found = pole.averages(0.0, 1.0, &rule, &mut averages).unwrap_err();
    // The first Gauss point beyond 1/2.
    let next = rule.smooth_quadrature().points.iter().map(|p| p[0]).filter(|&t| t > 0.5).fold(1.0, f64::min);
    assert_eq!(found, NotFinite { time: next, value: f64::INFINITY });
    // A function that sets nothing.
    let empty = TimeFunction::of_times("nothing", |_, _| ());
    assert!(empty.averages(0.0, 1.0, &rule, &mut averages).unwrap_err().value.is_nan());
}

#[test]
fn only_smooth_functions_need_a_rate() {
    let table = TimeFunction::constant().with_rate(|_, rates| rates.fill(7.0));
    assert_eq!((table.rate(0.0), table.has_rate()), (0.0, true));
    let values = |times: &[f64], values: &mut [f64]| values.copy_from_slice(times);
    let path = TimeFunction::from_acceleration(&TimeFunction::of_times("t", values), [0.0, 1.0]).unwrap();
    // u = t^3/6, v = t^2/2.
    assert!(
        path.has_rate()
            && (path.rate(0.5) - 0.125).abs() < 1e-15
            && (path.value(1.0) - 1.0 / 6.0).abs() < 1e-15
    );
}

/// t^2 up to t = 1, and 5 - t from there on.
fn of_two_pieces() -> TimeFunction {
    let pieces = |t: f64| if t < 1.0 { [t * t, 2.0 * t, 2.0] } else { [5.0 - t, -1.0, 0.0] };
    TimeFunction::smooth("pieces", pieces).with_kinks([1.0, 1.0])
}

#[test]
fn averages_are_exact_between_kinks() {
    // Integral of f over [0, 2.5]: 1/3 + 5 * 1.5 - (2.5^2 - 1)/2; of t f: 1/4 + 5 (2.5^2 - 1)/2 - (2.5^3 - 1)/3.
    let exact = [1.0 / 3.0 + 7.5 - 2.625, 0.25 + 13.125 - 14.625 / 3.0];
    for degree in 2..=4 {
        let rule = Rule::discrete_gradient(degree);
        let (b, c) = (rule.weights(), rule.nodes());
        let mut averages = [0.0; 4];
        of_two_pieces().averages(0.0, 2.5, &rule, &mut averages[..degree]).unwrap();
        let zeroth: f64 = (0..degree).map(|i| 2.5 * b[i] * averages[i]).sum();
        let first: f64 = (0..degree).map(|i| 2.5 * 2.5 * b[i] * c[i] * averages[i]).sum();
        assert!((zeroth - exact[0]).abs() < 1e-14 && (first - exact[1]).abs() < 1e-13, "{zeroth} {first}");
    }
}

#[test]
fn both_sides_of_a_kink_are_known() {
    let law = of_two_pieces();
    assert_eq!((law.kinks(), law.first_jump()), (vec![1.0], Some(1.0)));
    assert!((law.value_before(1.0) - 1.0).abs() < 1e-15 && law.value(1.0) == 4.0);
    assert!((law.rate_beside(1.0, -1e-9) - 2.0).abs() < 1e-8 && law.rate_beside(1.0, 1e-9) == -1.0);
    // From rest: v(2) = 1/3 + 5 - 3/2, u(2) = 1/12 + 1/3 + 5/2 - 2/3.
    let path = TimeFunction::from_acceleration(&law, [0.0, 3.0]).unwrap();
    assert!((path.rate(2.0) - (1.0 / 3.0 + 3.5)).abs() < 1e-14, "{}", path.rate(2.0));
    assert!(
        (path.value(2.0) - (1.0 / 12.0 + 1.0 / 3.0 + 2.5 - 2.0 / 3.0)).abs() < 1e-14,
        "{}",
        path.value(2.0)
    );
}
