//! Largest values of fields in each region, from its own cells: where regions meet, stresses jump.

use emmy::body::{Body, FieldName, FieldValues, Fields, Place, Selection};
use emmy::mesh::Mesh;
use emmy::motion::State;

use super::measures::{Extreme, counts};

/// The nodes and cells of each region that count on this rank.
#[derive(Debug)]
pub(crate) struct RegionMembers {
    /// Group of each region.
    names: Vec<String>,
    /// Empty if no field is at nodes.
    nodes: Vec<Selection>,
    /// Empty if no field is in cells.
    cells: Vec<Selection>,
}

impl RegionMembers {
    /// The members for some fields.
    pub(crate) fn new(body: &Body, fields: &Fields, names: &[FieldName]) -> Self {
        let (mesh, ranks) = (body.mesh(), body.ranks());
        let all: Vec<u32> = (0..mesh.n_cells() as u32).collect();
        let mut cells = by_region(body, &all);
        cells.resize(fields.regions().count(), Vec::new());
        let is_wanted = |place: Place| names.iter().any(|name| name.place() == place);
        let nodes = |cells: &Vec<u32>| {
            let mut nodes = nodes_of(mesh, cells);
            nodes.retain(|&node| counts(ranks, false, node as usize));
            fields.select_nodes_in(&nodes, cells.clone())
        };
        let own = |cells: &Vec<u32>| {
            let own = cells.iter().copied().filter(|&cell| counts(ranks, true, cell as usize));
            fields.select_cells(&own.collect::<Vec<_>>())
        };
        RegionMembers {
            names: fields.regions().map(|group| group.unwrap_or_default().to_string()).collect(),
            nodes: if is_wanted(Place::Nodes) { cells.iter().map(nodes).collect() } else { Vec::new() },
            cells: if is_wanted(Place::Cells) { cells.iter().map(own).collect() } else { Vec::new() },
        }
    }

    /// The largest value of each field in the body, then in the regions that have it if there are several. On a team a
    /// call of all ranks.
    pub(crate) fn extremes(
        &self,
        body: &Body,
        fields: &Fields,
        state: &State,
        names: &[FieldName],
    ) -> Vec<Extreme> {
        let State { displacement, velocity, .. } = state;
        let at = |place: Place| {
            names.iter().copied().filter(|name| name.place() == place).collect::<Vec<FieldName>>()
        };
        let (at_nodes, in_cells) = (at(Place::Nodes), at(Place::Cells));
        let values = |region: usize| {
            let of = |selection: Option<&Selection>, names: &[FieldName]| {
                let all = |selection: &Selection| fields.all_on(selection, [displacement, velocity], names);
                selection.filter(|_| !names.is_empty()).map_or_else(Vec::new, all)
            };
            let mut values = of(self.nodes.get(region), &at_nodes);
            values.extend(of(self.cells.get(region), &in_cells));
            values
        };
        let of_regions: Vec<Vec<FieldValues>> = (0..self.names.len()).map(values).collect();
        let whole = (body.mesh(), &**body.ranks());
        let largest = |name: FieldName| {
            let regions = (0..self.names.len()).filter(|&region| fields.region_has(region, name));
            let own = regions.filter_map(|region| {
                let values = of_regions[region].iter().find(|values| values.name == name)?;
                let selections = if name.place() == Place::Nodes { &self.nodes } else { &self.cells };
                let members = selections[region].members().iter().map(|&member| member as usize);
                Some((region, Extreme::of(whole, state, name, members, &values.numbers)))
            });
            let own: Vec<(usize, Option<Extreme>)> = own.collect();
            let has_several = own.len() > 1;
            let mut all: Vec<Extreme> = Vec::new();
            for (region, extreme) in own {
                let named =
                    |extreme: Extreme| Extreme { region: Some(self.names[region].clone()), ..extreme };
                all.extend(extreme.map(named));
            }
            let order =
                |a: &&Extreme, b: &&Extreme| a.value.total_cmp(&b.value).then(a.member.cmp(&b.member));
            let body = all.iter().max_by(order).cloned().map(|own| Extreme { region: None, ..own });
            body.into_iter().chain(if has_several { all } else { Vec::new() })
        };
        names.iter().flat_map(|&name| largest(name)).collect()
    }
}

/// Some cells by the number of their region, up to the last one that occurs.
pub(super) fn by_region(body: &Body, cells: &[u32]) -> Vec<Vec<u32>> {
    let mut all: Vec<Vec<u32>> = Vec::new();
    for &cell in cells {
        let region = body.region_of_cell()[cell as usize] as usize;
        all.resize_with(all.len().max(region + 1), Vec::new);
        all[region].push(cell);
    }
    all
}

/// Nodes of some cells, ascending.
pub(crate) fn nodes_of(mesh: &Mesh, cells: &[u32]) -> Vec<u32> {
    let mut nodes: Vec<u32> =
        cells.iter().flat_map(|&cell| mesh.cell(cell as usize).nodes).copied().collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use emmy::body::{PointMass, PointTerms, Region};
    use emmy::material::{Link, NeoHooke};
    use emmy::mesh::{CellKind, Mesh, MeshBuilder, Share, block, owners};
    use emmy::team::{Team, Threads};

    use super::*;

    const NAMES: [FieldName; 3] =
        [FieldName::VonMisesStress, FieldName::CellVonMisesStress, FieldName::AxialForce];

    /// A block whose lower half is soft, and a spring at its last node.
    fn mesh() -> Mesh {
        let whole = block([1.0, 4.0, 1.0], [1, 4, 1]).unwrap();
        let mut builder = MeshBuilder::new();
        whole.points().iter().for_each(|&point| _ = builder.point(point));
        for (index, cell) in whole.cells().enumerate() {
            let cell = builder.cell(cell.kind, cell.nodes).unwrap();
            builder.cell_group(if index < 2 { "soft" } else { "stiff" }, [cell]);
        }
        let end = builder.point([0.0, 6.0, 1.0]);
        let spring = builder.cell(CellKind::Line2, &[whole.n_nodes() as u32 - 1, end]).unwrap();
        builder.cell_group("spring", [spring]);
        builder.node_group("end", [end]);
        builder.build().unwrap()
    }

    fn extremes(mesh: Mesh, team: Option<(Arc<dyn Team>, Share)>) -> Vec<Extreme> {
        let rubber = |group: &str, mu: f64| Region::new(NeoHooke::new(0.0, mu).unwrap(), 1.0).on(group);
        let spring = Region::links(Link::spring(2.0, None).unwrap(), 0.0).on("spring");
        let masses = vec![PointMass { group: "end".into(), mass: 1.0 }];
        let builder = match team {
            Some((team, share)) => Body::shared(share, team),
            None => Body::builder(mesh),
        };
        let builder = builder.regions([rubber("soft", 3.0), rubber("stiff", 300.0), spring]);
        let body = builder.point_terms(PointTerms { masses, ..Default::default() }).build().unwrap();
        let mut state = State::initial(&body, 0.5, &[]).unwrap();
        state.displacement = body.mesh().points().iter().flat_map(|point| [point[0], 0.0, 0.0]).collect();
        let fields = Fields::new(&body);
        RegionMembers::new(&body, &fields, &NAMES).extremes(&body, &fields, &state, &NAMES)
    }

    /// Uniform stretch of 2 along x: von Mises stress `mu (4 - 1)/2`, also at the nodes between the regions.
    #[test]
    fn each_region_has_its_own_largest_stress_on_any_number_of_ranks() {
        let own = extremes(mesh(), None);
        let found: Vec<(&str, Option<&str>)> =
            own.iter().map(|own| (own.field.as_str(), own.region.as_deref())).collect();
        let rows = |field| [(field, None), (field, Some("soft")), (field, Some("stiff"))];
        let expected = [rows("von_mises_stress"), rows("cell_von_mises_stress")].concat();
        // The spring is the only region with an axial force; nothing stretches it.
        assert_eq!(found[..6], expected);
        assert_eq!(found[6..], [("axial_force", None)]);
        for own in &own[..6] {
            let exact = if own.region.as_deref() == Some("soft") { 4.5 } else { 450.0 };
            assert!((own.value - exact).abs() < 1e-12 * exact && own.time == 0.5, "{own:?}");
            assert!(own.region.as_deref() != Some("soft") || own.point[1] <= 2.0, "{own:?}");
        }
        assert!(own[6].value.abs() < 1e-12 && own[6].member == 4, "{own:?}");
        let owners = owners(&mesh(), 3).unwrap();
        let of_rank = |team: Arc<dyn Team>| {
            let share = Share::new(&mesh(), &owners, team.rank());
            extremes(mesh(), Some((team, share)))
        };
        for ranks in Threads::run(3, of_rank).unwrap() {
            let places = |all: &[Extreme]| {
                all.iter().map(|own| (own.field.clone(), own.region.clone(), own.is_cell)).collect::<Vec<_>>()
            };
            assert_eq!(places(&ranks), places(&own));
            for (rank, own) in ranks.iter().zip(&own) {
                assert!(
                    (rank.value - own.value).abs() < 1e-12 * own.value.abs().max(1.0),
                    "{rank:?} {own:?}"
                );
            }
        }
    }
}
