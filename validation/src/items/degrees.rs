//! Beyond the paper: degrees 1, 2 and 3.

use super::Effort;
use super::study::{Curves, Member, Reference, error_within, study};
use crate::case::Case;
use crate::claim::Item;
use crate::measure::order;
use crate::picture::Pictures;

const SCHEMES: [&str; 2] = ["AS(5)", "DGM"];

/// All schemes of all degrees, each degree with its step sizes.
fn members(sizes: [&[f64]; 3]) -> Vec<Member> {
    let member = |scheme, k: usize| Member { scheme, degree: k, sizes: sizes[k - 1].to_vec() };
    SCHEMES.iter().flat_map(|&scheme| (1..=3).map(move |k| member(scheme, k))).collect()
}

/// A motion that every step resolves.
pub(super) fn smooth(effort: Effort, pictures: &Pictures) -> Result<Item, String> {
    let sizes: [&[f64]; 3] = match effort.quick {
        true => [&[0.05, 0.025], &[0.1, 0.05], &[0.1, 0.05]],
        false => [
            &[0.1, 0.05, 0.025, 0.0125, 0.00625, 0.003125],
            &[0.2, 0.1, 0.05, 0.025, 0.0125],
            &[0.2, 0.1, 0.05, 0.025],
        ],
    };
    let case = Case::new("degrees-smooth");
    let reference = Reference("DGM", 5, 0.0125);
    let curves = study(&case, (0.0, 1.0), &reference, members(sizes), &pictures.folder)?;
    let mut item = Item::new(
        "degrees-smooth",
        "Beyond the paper: degrees 1, 2, 3 on a smooth motion",
        "A soft block of 32 cells, stretched, sheared and turned by its initial velocity, so slowly that the steps resolve every mode. \
        AS and DGM of degree k have order 2k.",
    );
    let guides = [(2, "DGM", 1), (4, "DGM", 2), (6, "DGM", 3)];
    curves.show_errors(&mut item, pictures, "Smooth motion", &guides)?;
    curves.show_costs(&mut item, pictures, "Smooth motion: error over time")?;
    for scheme in SCHEMES {
        for k in 1..=3 {
            let (order, expected) = (curves.order(scheme, k), 2.0 * k as f64);
            item.claim(
                format!("{scheme} of degree {k} converges with order {expected}"),
                format!("order {order:.2}"),
                (order - expected).abs() < 0.25,
            );
        }
    }
    if !effort.quick {
        for scheme in SCHEMES {
            higher_is_cheaper(&mut item, &curves, scheme, 10.0);
        }
    }
    Ok(item)
}

/// The loaded block, whose highest modes no step resolves.
pub(super) fn block(effort: Effort, pictures: &Pictures) -> Result<Item, String> {
    let sizes: [&[f64]; 3] = match effort.quick {
        true => [&[0.02, 0.01], &[0.05, 0.025], &[0.05, 0.025]],
        false => [
            &[0.04, 0.02, 0.01, 0.005, 0.0025],
            &[0.1, 0.05, 0.025, 0.0125, 0.00625],
            &[0.1, 0.05, 0.025, 0.0125],
        ],
    };
    let case = Case::new("degrees-block");
    let reference = Reference("DGM", 4, if effort.quick { 0.005 } else { 0.001 });
    let curves = study(&case, (1.0, 2.0), &reference, members(sizes), &pictures.folder)?;
    let mut item = Item::new(
        "degrees-block",
        "Beyond the paper: degrees 1, 2, 3 on the loaded block",
        "Free flight of the large-strain block on 1 < t < 2 from the state at t = 1. The load and the corners excite modes of the mesh up to \
        omega of about 230: a step of 0.04 turns the fastest one by 9 radians, and no scheme can follow it. While omega h is not small for the modes \
        that carry energy, higher degrees do not show their order 2k but slopes near 2 with smaller constants: each smaller step resolves some more \
        modes than the one before. With h below 0.0125, omega h below 3, the slopes of degrees 2 and 3 begin to rise.",
    );
    curves.show_errors(&mut item, pictures, "Loaded block", &[(2, "DGM", 3)])?;
    curves.show_costs(&mut item, pictures, "Loaded block: error over time")?;
    for scheme in SCHEMES {
        for k in 2..=3 {
            let [first, other] = [(1, 0.02), (k, 0.05)].map(|(k, h)| curves.error(scheme, k, h));
            item.claim(
                format!("{scheme} of degree {k} with h = 0.05 is more accurate than degree 1 with h = 0.02"),
                format!("error {other:.1e} against {first:.1e}"),
                other < first,
            );
            let slope = order((0.05, other), (0.025, curves.error(scheme, k, 0.025)));
            item.claim(
                format!("its slope is near 2 from h = 0.05 to 0.025, not {}", 2 * k),
                format!("{slope:.2}"),
                (slope - 2.0).abs() < 0.4,
            );
        }
    }
    if !effort.quick {
        for scheme in SCHEMES {
            higher_is_cheaper(&mut item, &curves, scheme, 1.0);
        }
    }
    Ok(item)
}

/// Claims that degree 2 has a smaller error than degree 1 at the time that the finest run of degree 1 takes.
fn higher_is_cheaper(item: &mut Item, curves: &Curves, scheme: &str, times: f64) {
    let own = curves.costs(scheme, 1);
    let Some(&(cost, error)) = own.last() else { return };
    let other = curves.costs(scheme, 2);
    let other = error_within(&other, cost).unwrap_or(f64::NAN);
    item.claim(
        format!("{scheme}: degree 2 has the smaller error at equal time"),
        format!("{:.1} times smaller at {cost:.2} s", error / other),
        error / other > times,
    );
}
