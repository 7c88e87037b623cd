//! Sections of MSH 2.0 to 2.2.

use super::super::Result;
use super::cursor::{Cursor, Encoding};
use super::draft::{Draft, Tags};
use super::shape::Shape;

/// `$Nodes`: the count as text, then number and coordinates of each node.
pub(super) fn nodes(cursor: &mut Cursor, draft: &mut Draft) -> Result<()> {
    let count = cursor.count_line("nodes", 8)?;
    for _ in 0..count {
        let start = cursor.offset();
        let number = cursor.whole()?;
        let point = cursor.point()?;
        draft.node(cursor, start, number, point)?;
    }
    Ok(())
}

/// `$ParametricNodes`: as `$Nodes`, with the geometry on which each node lies and its parameters there.
pub(super) fn parametric_nodes(cursor: &mut Cursor, draft: &mut Draft) -> Result<()> {
    let count = cursor.count_line("nodes", 8)?;
    for _ in 0..count {
        let start = cursor.offset();
        let number = cursor.whole()?;
        let point = cursor.point()?;
        let dim = cursor.int()?;
        cursor.int()?; // number of the geometry
        cursor.skip_reals(if matches!(dim, 1 | 2) { dim as u64 } else { 0 })?;
        draft.node(cursor, start, number, point)?;
    }
    Ok(())
}

/// `$Elements`: the count as text, then a line each (ASCII) or blocks of one type (binary).
pub(super) fn elements(cursor: &mut Cursor, draft: &mut Draft) -> Result<()> {
    let count = cursor.count_line("elements", 6)?;
    let mut left = count;
    while left > 0 {
        let start = cursor.offset();
        let n_read =
            if cursor.encoding == Encoding::Ascii { line(cursor, draft)? } else { block(cursor, draft)? };
        if n_read == 0 || n_read > left {
            return Err(
                cursor.malformed(start, format!("a block of {n_read} elements where {left} are left"))
            );
        }
        left -= n_read;
    }
    Ok(())
}

fn line(cursor: &mut Cursor, draft: &mut Draft) -> Result<u64> {
    let start = cursor.offset();
    let number = cursor.whole()?;
    let id = cursor.int()?;
    let shape = super::shape(cursor, start, id)?;
    let n_tags = cursor.count("tags", 2)?;
    element(cursor, draft, start, number, shape, n_tags)?;
    Ok(1)
}

fn block(cursor: &mut Cursor, draft: &mut Draft) -> Result<u64> {
    let start = cursor.offset();
    let id = cursor.int()?;
    let shape = super::shape(cursor, start, id)?;
    let count = cursor.whole()?;
    let n_tags = cursor.whole()?;
    let count = cursor.checked_count(start, "elements", count, 4)?;
    let n_tags = cursor.checked_count(start, "tags", n_tags, 4)?;
    for _ in 0..count {
        let start = cursor.offset();
        let number = cursor.whole()?;
        element(cursor, draft, start, number, shape, n_tags)?;
    }
    Ok(count)
}

/// Tags and nodes of an element. The first tag is the physical group (0: none); the third one is the number of
/// partitions, which follow: the element's own, and as negative numbers those with a copy.
fn element(
    cursor: &mut Cursor,
    draft: &mut Draft,
    start: usize,
    number: u64,
    shape: &'static Shape,
    n_tags: u64,
) -> Result<()> {
    let (mut physical, mut partitions) = (0, Vec::new());
    for tag in 0..n_tags {
        let value = cursor.int()?;
        match tag {
            0 => physical = value.unsigned_abs(),
            1 | 2 => {}
            _ => partitions.push(value),
        }
    }
    let mut nodes = [0; Shape::MAX_NODES];
    for node in &mut nodes[..shape.n_nodes] {
        *node = cursor.whole()?;
    }
    let copies = partitions.iter().filter(|partition| **partition < 0);
    copies.for_each(|partition| draft.partitions.add_ghost(number, partition.unsigned_abs()));
    partitions.retain(|partition| *partition > 0);
    let partition = if let [partition] = partitions[..] { partition.unsigned_abs() } else { 0 };
    let groups: &[u64] = if physical == 0 { &[] } else { &[physical] };
    let tags = Tags { groups, partition };
    draft.element(cursor, start, number, shape, tags, &nodes[..shape.n_nodes])
}
