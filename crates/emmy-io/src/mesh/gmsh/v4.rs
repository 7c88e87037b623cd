//! Sections of MSH 4.1.

use std::collections::HashMap;

use super::super::Result;
use super::cursor::Cursor;
use super::draft::Draft;
use super::shape::Shape;

/// Physical groups of the entities, by dimension and number of the entity.
pub(super) type Entities = HashMap<(u8, i64), Vec<u64>>;

/// `$Entities`: only the physical groups of each entity are used.
pub(super) fn entities(cursor: &mut Cursor, entities: &mut Entities) -> Result<()> {
    for (dim, count) in entity_counts(cursor)? {
        for _ in 0..count {
            let number = cursor.int()?;
            let groups = entity_groups(cursor, dim)?;
            entities.insert((dim, number), groups);
        }
    }
    Ok(())
}

/// `$PartitionedEntities`: the elements of a partitioned mesh belong to these, not to `$Entities`.
pub(super) fn partitioned_entities(cursor: &mut Cursor, entities: &mut Entities) -> Result<()> {
    cursor.size()?; // number of partitions
    let n_ghosts = cursor.count("ghost entities", 4)?;
    for _ in 0..2 * n_ghosts {
        cursor.int()?;
    }
    for (dim, count) in entity_counts(cursor)? {
        for _ in 0..count {
            let number = cursor.int()?;
            let _parent = [cursor.int()?, cursor.int()?];
            cursor.skip_ints()?; // partitions
            let groups = entity_groups(cursor, dim)?;
            entities.insert((dim, number), groups);
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
fn entity_groups(cursor: &mut Cursor, dim: u8) -> Result<Vec<u64>> {
    cursor.skip_reals(if dim == 0 { 3 } else { 6 })?;
    let count = cursor.count("physical groups", 2)?;
    let groups = (0..count).map(|_| cursor.int().map(i64::unsigned_abs)).collect::<Result<Vec<u64>>>()?;
    if dim > 0 {
        cursor.skip_ints()?;
    }
    Ok(groups)
}

/// `$Nodes`: blocks of one entity, first the numbers, then the coordinates.
pub(super) fn nodes(cursor: &mut Cursor, draft: &mut Draft) -> Result<()> {
    let n_blocks = cursor.count("blocks of nodes", 8)?;
    let _total_min_max = [cursor.size()?, cursor.size()?, cursor.size()?];
    for _ in 0..n_blocks {
        node_block(cursor, draft)?;
    }
    Ok(())
}

fn node_block(cursor: &mut Cursor, draft: &mut Draft) -> Result<()> {
    let start = cursor.offset();
    let dim = cursor.whole()?;
    let _entity = cursor.int()?;
    let parametric = cursor.int()?;
    if dim > 3 {
        return Err(cursor.malformed(start, format!("a block of nodes of dimension {dim}")));
    }
    let count = cursor.count("nodes", 8)?;
    let numbers = (0..count).map(|_| cursor.size()).collect::<Result<Vec<u64>>>()?;
    for number in numbers {
        let start = cursor.offset();
        let point = cursor.point()?;
        cursor.skip_reals(if parametric != 0 { dim } else { 0 })?;
        draft.node(cursor, start, number, point)?;
    }
    Ok(())
}

/// `$Elements`: blocks of one entity and type.
pub(super) fn elements(cursor: &mut Cursor, draft: &mut Draft, entities: &Entities) -> Result<()> {
    let n_blocks = cursor.count("blocks of elements", 8)?;
    let _total_min_max = [cursor.size()?, cursor.size()?, cursor.size()?];
    for _ in 0..n_blocks {
        element_block(cursor, draft, entities)?;
    }
    Ok(())
}

fn element_block(cursor: &mut Cursor, draft: &mut Draft, entities: &Entities) -> Result<()> {
    let start = cursor.offset();
    let (_dim, entity, id) = (cursor.int()?, cursor.int()?, cursor.int()?);
    let shape = super::shape(cursor, start, id)?;
    let groups = entities.get(&(shape.dim, entity)).map(Vec::as_slice).unwrap_or_default();
    let count = cursor.count("elements", 4)?;
    let mut nodes = [0; Shape::MAX_NODES];
    for _ in 0..count {
        let start = cursor.offset();
        let number = cursor.size()?;
        for node in &mut nodes[..shape.n_nodes] {
            *node = cursor.size()?;
        }
        draft.element(cursor, start, number, shape, groups, &nodes[..shape.n_nodes])?;
    }
    Ok(())
}
