//! Sections of MSH 1, which is text only.

use super::super::Result;
use super::cursor::Cursor;
use super::draft::{Draft, Tags};
use super::shape::Shape;

/// `$ELM`: number, type, physical group (0: none), geometry, number of nodes, and nodes of each element.
pub(super) fn elements(cursor: &mut Cursor, draft: &mut Draft) -> Result<()> {
    let count = cursor.count_line("elements", 6)?;
    let mut nodes = [0; Shape::MAX_NODES];
    for _ in 0..count {
        let start = cursor.offset();
        let number = cursor.whole()?;
        let id = cursor.int()?;
        let shape = super::shape(cursor, start, id)?;
        let physical = cursor.int()?.unsigned_abs();
        cursor.int()?;
        let n_nodes = cursor.whole()?;
        if n_nodes != shape.n_nodes as u64 {
            let problem =
                format!("element {number} ({}) has {n_nodes} nodes instead of {}", shape.name, shape.n_nodes);
            return Err(cursor.malformed(start, problem));
        }
        for node in &mut nodes[..shape.n_nodes] {
            *node = cursor.whole()?;
        }
        let groups: &[u64] = if physical == 0 { &[] } else { &[physical] };
        let tags = Tags { groups, ..Tags::default() };
        draft.element(cursor, start, number, shape, tags, &nodes[..shape.n_nodes])?;
    }
    Ok(())
}
