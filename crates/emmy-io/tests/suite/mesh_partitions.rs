//! Files of Gmsh that are one part of a mesh in partitions.

use crate::meshes::{parse_text, volume};

/// Four bricks in a row along x with their upper faces; the first two bricks are partition 1, the others partition 2.
/// The group of an element is 1 for a brick and 2 for a face. `copies` tells whether neighbours of the other partition
/// are listed; `n` first bricks are in the file. As Gmsh writes it, copies in MSH 4 are cells without faces and groups.
fn file(version: &str, copies: bool, n: usize) -> String {
    let nodes: Vec<String> = (0..20).map(|i| format!("{} {} {}", i / 4, i % 2, i / 2 % 2)).collect();
    let corner = |i: usize, corners: &[usize]| -> String {
        corners.iter().map(|corner| format!(" {}", 1 + 4 * i + corner)).collect()
    };
    let brick = |i: usize| corner(i, &[0, 4, 5, 1, 2, 6, 7, 3]);
    let face = |i: usize| corner(i, &[2, 6, 7, 3]);
    let names = "$PhysicalNames\n2\n3 1 \"body\"\n2 2 \"top\"\n$EndPhysicalNames\n";
    if version == "2.2" {
        let nodes: String = nodes.iter().enumerate().map(|(i, node)| format!("{} {node}\n", i + 1)).collect();
        let tags = |i: usize, group: usize| match ["1", "1 -2", "2 -1", "2"][i] {
            tags if copies && tags.len() > 1 => format!("5 {group} 1 2 {tags}"),
            tags => format!("4 {group} 1 1 {}", &tags[..1]),
        };
        let elements: String = (0..n)
            .map(|i| {
                let [brick_tags, face_tags] = [1, 2].map(|group| tags(i, group));
                format!("{} 5 {brick_tags}{}\n{} 3 {face_tags}{}\n", i + 1, brick(i), i + 11, face(i))
            })
            .collect();
        return format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{names}$Nodes\n20\n{nodes}$EndNodes\n$Elements\n{}\n{elements}$EndElements\n",
            2 * n
        );
    }
    // Surfaces and volumes 1 and 2 of the partitions 1 and 2.
    let entities: String = [2, 1]
        .into_iter()
        .flat_map(|group| [1, 2].map(|own| format!("{own} 3 1 1 {own} 0 0 0 9 9 9 1 {group} 0\n")))
        .collect();
    let numbers: String = (1..21).map(|number| format!("{number}\n")).collect();
    let (mut blocks, mut n_blocks) = (String::new(), 0);
    let mut block = |dim: usize, entity: usize, lines: Vec<String>| {
        n_blocks += 1;
        let kind = if dim == 2 { 3 } else { 5 };
        blocks += &format!("{dim} {entity} {kind} {}\n{}", lines.len(), lines.concat());
    };
    for (own, bricks) in [(1, 0..2), (2, 2..n)] {
        if own == 2 && n == 3 {
            // The volume 3 has the copies for partition 1.
            block(3, 3, vec![format!("3{}\n", brick(2))]);
        } else if !bricks.is_empty() {
            block(2, own, bricks.clone().map(|i| format!("{}{}\n", i + 11, face(i))).collect());
            block(3, own, bricks.map(|i| format!("{}{}\n", i + 1, brick(i))).collect());
        }
    }
    // A part lists what it has of others alone, the whole mesh all copies.
    let rows = &["3 2 1 1\n", "2 1 1 2\n"][..if n == 4 { 2 } else { 1 }];
    let ghosts = format!("$GhostElements\n{}\n{}$EndGhostElements\n", rows.len(), rows.concat());
    format!(
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n{names}$PartitionedEntities\n2\n2\n3 1\n4 2\n0 0 2 2\n{entities}$EndPartitionedEntities\n\
         $Nodes\n1 20 1 20\n3 1 0 20\n{numbers}{}\n$EndNodes\n$Elements\n{n_blocks} {} 1 20\n{blocks}$EndElements\n{}",
        nodes.join("\n"),
        2 * n,
        if copies { ghosts } else { String::new() }
    )
}

/// Number of cells, upper faces and notes.
fn read(text: &str) -> (usize, usize, Vec<String>) {
    let file = parse_text("part.msh", text).unwrap_or_else(|error| panic!("{error}"));
    let n_cells = file.mesh.n_cells();
    assert_eq!(file.mesh.groups().cells("body").unwrap().len(), n_cells);
    assert!((volume(&file.mesh) - n_cells as f64).abs() < 1e-14);
    (n_cells, file.mesh.groups().facets("top").unwrap().len(), file.notes)
}

#[test]
fn copies_of_cells_are_left_out_of_one_part() {
    for (version, n_ghosts, part) in [
        (
            "2.2",
            "2 ghost elements are",
            "all cells belong to partition 1; those of other partitions, if there are any, are in other files",
        ),
        ("4.1", "1 ghost element is", "the file has only partition 1 of 2; the others are in other files"),
    ] {
        let (n_cells, n_facets, notes) = read(&file(version, true, 3));
        assert_eq!((n_cells, n_facets), (2, 2), "{version}");
        let unused = "8 nodes belong to no cell and are left out";
        assert_eq!(notes, [&*format!("{n_ghosts} left out"), part, unused], "{version}");
        let (n_cells, n_facets, notes) = read(&file(version, false, 2));
        assert_eq!((n_cells, n_facets, &notes[..]), (2, 2, &[part.to_string(), unused.to_string()][..]));
    }
}

#[test]
fn the_whole_mesh_in_one_file_keeps_all_cells() {
    for version in ["2.2", "4.1"] {
        for copies in [true, false] {
            assert_eq!(read(&file(version, copies, 4)), (4, 4, Vec::new()), "{version} {copies}");
        }
    }
}
