//! Files that are not valid inputs.

use super::{BOX, MESH, Mistake, changed, whole};

pub(super) fn all() -> Vec<Mistake> {
    let utf16: Vec<u8> = BOX.encode_utf16().flat_map(u16::to_le_bytes).collect();
    vec![
        whole("bytes-that-are-no-text", *b"title = \"a\"\n\xff\xfe\x00\x01"),
        whole("latin-1", *b"title = \"Tr\xe4ger\"\n"),
        whole("utf-16", [&b"\xff\xfe"[..], &utf16].concat()),
        whole("mesh-for-an-input", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"),
        whole("json", "{ \"mesh\": { \"l-block\": { \"cell_size\": 1.0 } } }\n"),
        whole("yaml", "mesh:\n  l-block:\n    cell_size: 1.0\n"),
        whole("abaqus-for-an-input", "*Heading\n*Node\n1, 0.0, 0.0, 0.0\n"),
        changed("key-twice", "density = 2.0", "density = 2.0\ndensity = 3.0"),
        changed("section-twice", "[[load]]", "[mesh]\nscale = 2.0\n\n[[load]]"),
        changed("section-and-list", "[[load]]", "[region]\n\n[[load]]"),
        changed("bracket-left-open", "[mesh]", "[mesh"),
        changed("list-left-open", "traction = [0.0, 0.0, 10.0]", "traction = [0.0, 0.0, 10.0"),
        changed("quote-left-open", "group = \"body\"", "group = \"body"),
        changed("windows-path", MESH, "file = \"C:\\meshes\\part.msh\""),
        changed("nul", "title = \"box\"", "title = \"b\0x\""),
        whole("nested-without-end", format!("title = {}1{}\n", "[".repeat(500), "]".repeat(500))),
        changed("not-an-input-beside-tabs", "density = 2.0", "\tdensity\t=\t-2.0"),
        whole("text-that-ends-in-bytes", *b"title = \"a\"\n\xff\xfe"),
        changed("key-twice-with-one-value", "density = 2.0", "density = 2.0\ndensity = 2.0"),
    ]
}
