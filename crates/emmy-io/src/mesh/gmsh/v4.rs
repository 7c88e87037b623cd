//! Sections of MSH 4.0 and 4.1.
//!
//! In 4.0 points have a box, not a position; nodes and elements have numbers of 4 bytes, each number of a node stands
//! before its position, and blocks name the entity before its dimension.

use std::collections::HashMap;

use super::super::Result;
use super::Version;
use super::cursor::Cursor;
use super::draft::{Draft, Tags};
use super::shape::Shape;

/// Physical groups and partition of an entity; 0: no partition, or several.
#[derive(Default)]
pub(super) struct Entity {
    groups: Vec<u64>,
    partition: u64,
}

/// Entities by dimension and number.
pub(super) type Entities = HashMap<(u8, i64), Entity>;

/// `$Entities`: only the physical groups of each entity are used.
pub(super) fn entities(cursor: &mut Cursor, version: Version, entities: &mut Entities) -> Result<()> {
    for (dim, count) in entity_counts(cursor)? {
        for _ in 0..count {
            let number = cursor.int()?;
            let groups = entity_groups(cursor, version, dim)?;
            entities.insert((dim, number), Entity { groups, partition: 0 });
        }
    }
    Ok(())
}

/// `$PartitionedEntities`: the elements of a partitioned mesh belong to these, not to `$Entities`.
pub(super) fn partitioned_entities(
    cursor: &mut Cursor,
    version: Version,
    draft: &mut Draft,
    entities: &mut Entities,
) -> Result<()> {
    draft.partitions.count = Some(cursor.size()?);
    let n_ghosts = cursor.count("ghost entities", 4)?;
    for _ in 0..2 * n_ghosts {
        cursor.int()?;
    }
    for (dim, count) in entity_counts(cursor)? {
        for _ in 0..count {
            let number = cursor.int()?;
            let _parent = [cursor.int()?, cursor.int()?];
            let n_partitions = cursor.count("partitions", 2)?;
            let partitions = (0..n_partitions).map(|_| cursor.int()).collect::<Result<Vec<i64>>>()?;
            let partition = if let [partition] = partitions[..] { partition.unsigned_abs() } else { 0 };
            let groups = entity_groups(cursor, version, dim)?;
            entities.insert((dim, number), Entity { groups, partition });
        }
    }
    Ok(())
}

/// `$GhostElements`: number and partition of each element that others have a copy of, with their partitions.
pub(super) fn ghosts(cursor: &mut Cursor, version: Version, draft: &mut Draft) -> Result<()> {
    let count = cursor.count("ghost elements", 8)?;
    for _ in 0..count {
        let element = if version == Version::V41 { cursor.size()? } else { cursor.whole()? };
        let _partition = cursor.int()?;
        for _ in 0..cursor.count("partitions", 2)? {
            draft.partitions.add_ghost(element, cursor.int()?.unsigned_abs());
        }
    }
    Ok(())
}

fn entity_counts(cursor: &mut Cursor) -> Result<[(u8, u64); 4]> {
    let mut counts = [(0, 0); 4];
    for dim in 0..4 {
        counts[dim] = (dim as u8, cursor.count("entities", 8)?);
    }
    Ok(counts)
}

/// Position or bounding box, physical groups, and boundary of an entity.
fn entity_groups(cursor: &mut Cursor, version: Version, dim: u8) -> Result<Vec<u64>> {
    cursor.skip_reals(if dim == 0 && version == Version::V41 { 3 } else { 6 })?;
    let count = cursor.count("physical groups", 2)?;
    let groups = (0..count).map(|_| cursor.int().map(i64::unsigned_abs)).collect::<Result<Vec<u64>>>()?;
    if dim > 0 {
        cursor.skip_ints()?;
    }
    Ok(groups)
}

/// `$Nodes`: blocks of one entity, first the numbers, then the coordinates.
pub(super) fn nodes(cursor: &mut Cursor, version: Version, draft: &mut Draft) -> Result<()> {
    let n_blocks = cursor.count("blocks of nodes", 8)?;
    skip_totals(cursor, version)?;
    for _ in 0..n_blocks {
        node_block(cursor, version, draft)?;
    }
    Ok(())
}

/// Total, and in 4.1 the smallest and the largest number.
fn skip_totals(cursor: &mut Cursor, version: Version) -> Result<()> {
    let n = if version == Version::V41 { 3 } else { 1 };
    (0..n).try_for_each(|_| cursor.size().map(drop))
}

fn node_block(cursor: &mut Cursor, version: Version, draft: &mut Draft) -> Result<()> {
    let start = cursor.offset();
    let [dim, _entity] = dimension_and_entity(cursor, version)?;
    let parametric = cursor.int()?;
    let Ok(dim @ 0..=3) = u64::try_from(dim) else {
        return Err(cursor.malformed(start, format!("a block of nodes of dimension {dim}")));
    };
    let count = cursor.count("nodes", 8)?;
    let n_parameters = if parametric != 0 { dim } else { 0 };
    if version == Version::V40 {
        for _ in 0..count {
            let start = cursor.offset();
            let number = cursor.whole()?;
            let point = cursor.point()?;
            cursor.skip_reals(n_parameters)?;
            draft.node(cursor, start, number, point)?;
        }
        return Ok(());
    }
    let numbers = (0..count).map(|_| cursor.size()).collect::<Result<Vec<u64>>>()?;
    for number in numbers {
        let start = cursor.offset();
        let point = cursor.point()?;
        cursor.skip_reals(n_parameters)?;
        draft.node(cursor, start, number, point)?;
    }
    Ok(())
}

/// Dimension and number of the entity of a block.
fn dimension_and_entity(cursor: &mut Cursor, version: Version) -> Result<[i64; 2]> {
    let [first, second] = [cursor.int()?, cursor.int()?];
    Ok(if version == Version::V41 { [first, second] } else { [second, first] })
}

/// `$Elements`: blocks of one entity and type.
pub(super) fn elements(
    cursor: &mut Cursor,
    version: Version,
    draft: &mut Draft,
    entities: &Entities,
) -> Result<()> {
    let n_blocks = cursor.count("blocks of elements", 8)?;
    skip_totals(cursor, version)?;
    for _ in 0..n_blocks {
        element_block(cursor, version, draft, entities)?;
    }
    Ok(())
}

fn element_block(
    cursor: &mut Cursor,
    version: Version,
    draft: &mut Draft,
    entities: &Entities,
) -> Result<()> {
    let start = cursor.offset();
    let [_dim, entity] = dimension_and_entity(cursor, version)?;
    let id = cursor.int()?;
    let shape = super::shape(cursor, start, id)?;
    let tags = entities
        .get(&(shape.dim, entity))
        .map_or(Tags::default(), |entity| Tags { groups: &entity.groups, partition: entity.partition });
    let count = cursor.count("elements", 4)?;
    let mut nodes = [0; Shape::MAX_NODES];
    for _ in 0..count {
        let start = cursor.offset();
        let mut next = || if version == Version::V41 { cursor.size() } else { cursor.whole() };
        let number = next()?;
        for node in &mut nodes[..shape.n_nodes] {
            *node = next()?;
        }
        draft.element(cursor, start, number, shape, tags, &nodes[..shape.n_nodes])?;
    }
    Ok(())
}
