//! Part I's N-body problem: point masses, and links whose energy is a function of their length.

use super::study::{Member, Reference, study};
use super::{CONSERVED, Effort};
use crate::case::Case;
use crate::claim::Item;
use crate::measure::{energy_drift, momentum_drift};
use crate::picture::{Pictures, Series};

/// Two bodies that attract each other.
pub(super) fn two_body(_: Effort, pictures: &Pictures) -> Result<Item, String> {
    let mut item = Item::new(
        "two-body",
        "Part I: two bodies",
        "Kepler's problem with an eccentricity of 0.63, for a hundred revolutions of some ninety steps; F is the vector between the bodies, C the \
        square of its length, and the rules for the stress are those of the solids.",
    );
    conserving(&mut item, "two-body")?;
    let run = Case::new("two-body").with("time.steps", "[{ until = 20.0, size = 0.02 }]").run()?;
    let orbit = |body: usize| run.positions.iter().map(|q| (q[body][0], q[body][1])).collect();
    let series = vec![Series::line("heavier body", orbit(0)), Series::line("lighter body", orbit(1))];
    item.pictures.push(pictures.linear(
        "two-body-orbit",
        "Ten revolutions with DGM, k = 1",
        ["x", "y"],
        series,
    )?);
    let sizes: [&[f64]; 3] = [&[0.01, 0.005, 0.0025], &[0.02, 0.01, 0.005, 0.0025], &[0.02, 0.01, 0.005]];
    orders(&mut item, pictures, "two-body", sizes, Reference("DGM", 6, 0.00125))?;
    Ok(item)
}

/// Masses on springs.
pub(super) fn spring_network(_: Effort, pictures: &Pictures) -> Result<Item, String> {
    let mut item = Item::new(
        "spring-network",
        "Part I: masses on springs",
        "Six masses on twelve springs and three struts tumble and shake in space.",
    );
    conserving(&mut item, "spring-network")?;
    let sizes: [&[f64]; 3] = [&[0.04, 0.02, 0.01], &[0.1, 0.05, 0.025], &[0.2, 0.1, 0.05]];
    orders(&mut item, pictures, "spring-network", sizes, Reference("DGM", 6, 0.025))?;
    Ok(item)
}

/// Claims that DGM of degrees 1 to 3 keeps energy and angular momentum.
fn conserving(item: &mut Item, file: &'static str) -> Result<(), String> {
    for degree in 1..=3 {
        let case = Case::new(file).with("time.degree", degree);
        let run = case.run()?;
        let (energy, momentum) = (energy_drift(&run.records), momentum_drift(&run.records));
        item.claim(
            format!(
                "DGM of degree {degree} keeps energy and angular momentum through {} steps",
                run.records.len() - 1
            ),
            format!("drift of H {energy:.1e}, of L {momentum:.1e}"),
            run.failure.is_none() && energy.max(momentum) < CONSERVED,
        );
        item.commands.push(case.command());
    }
    Ok(())
}

/// Claims that DGM of degrees 1 to 3 converges with order 2k.
fn orders(
    item: &mut Item,
    pictures: &Pictures,
    file: &'static str,
    sizes: [&[f64]; 3],
    reference: Reference,
) -> Result<(), String> {
    let members = (1..=3).map(|degree| Member { scheme: "DGM", degree, sizes: sizes[degree - 1].to_vec() });
    let curves = study(&Case::new(file), (0.0, 2.0), &reference, members.collect(), &pictures.folder)?;
    let guides = [(2, "DGM", 1), (4, "DGM", 2), (6, "DGM", 3)];
    curves.show_errors(item, pictures, "Error over step size", &guides)?;
    for degree in 1..=3 {
        let (order, expected) = (curves.order("DGM", degree), 2.0 * degree as f64);
        item.claim(
            format!("DGM of degree {degree} converges with order {expected}"),
            format!("order {order:.2}"),
            (order - expected).abs() < 0.25,
        );
    }
    Ok(())
}
