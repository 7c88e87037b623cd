//! Meshes of several parts on the command line.

use super::Place;
use super::decks;

const TIME: &str = "[time]\nscheme = 'DGM'\ndegree = 1\nsteps = [{ until = 0.5, size = 0.05 }]\n";

/// Natural frequencies do not change where a deck is a part that is turned and shifted: its rigid elements, couplings,
/// masses with their inertia, springs and joints move with it.
#[test]
fn a_deck_vibrates_alike_at_any_place() {
    let place = Place::new();
    for (name, expected) in decks::decks() {
        for (extension, group) in [("inp", "FIX"), ("bdf", "spc_1")] {
            let alone = decks::input(&name, extension, group);
            let (file, rest) = alone.split_once('\n').unwrap();
            let part = format!(
                "mesh.parts = [{{ name = 'p', {}, turn = {{ axis = [1, -2, 0.5], angle = 0.7, about = [1, 0, 0] }}, at = \
                 [3, -1, 2] }}]",
                file.replacen("mesh.", "", 1)
            );
            let input = format!("{part}\n{}", rest.replace(&format!("'{group}'"), &format!("'p-{group}'")));
            place.write("deck.toml", &input);
            let output = format!("{name}-{extension}");
            let n = expected.len().to_string();
            let outcome = place.emmy(&["modes", "deck.toml", "--count", &n, "--output", &output]);
            assert_eq!(outcome.code, 0, "{name}.{extension}: {}", outcome.stderr);
            let modes = place.read(&format!("{output}/modes.csv"));
            let own: Vec<f64> =
                modes.lines().skip(1).map(|row| row.split(',').nth(2).unwrap().parse().unwrap()).collect();
            // CalculiX prints seven digits.
            let off = own.iter().zip(&expected).map(|(own, due)| (own / due - 1.0).abs()).fold(0.0, f64::max);
            assert!(own.len() == expected.len() && off < 1e-6, "{name}.{extension}: {own:?} {expected:?}");
        }
    }
}

/// `check`, `run`, `resume` and the written input know parts, of which one is a file that may move.
#[test]
fn parts_are_checked_run_and_resumed() {
    let place = Place::new();
    place.write(
        "tet.inp",
        "*Node\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*Element, type=C3D4, elset=tet\n1, 1,2,3,4\n",
    );
    let input = format!(
        "[mesh]\nparts = [{{ name = 'ball', ball = {{ radius = 0.5, cells = 2 }}, at = [0, 0, 3] }}, {{ name = 'a', file = \
         'tet.inp', scale = 2 }}]\n[[region]]\ndensity = 2\nmaterial.neo-hooke = {{ lambda = 1000, mu = 500 }}\n[[initial]]\n\
         group = 'a-tet'\nvelocity = [1, 0, 0]\n{TIME}"
    );
    place.write("two.toml", &input);
    let check = place.succeed(&["check", "two.toml"]);
    for part in
        ["group      a-tet: 1 cell, 4 nodes", "group      ball-surface: 24 facets, 26 nodes", "parts      2"]
    {
        assert!(check.stdout.contains(part), "{part}\n{}", check.stdout);
    }
    place.succeed(&["run", "two.toml", "--quiet", "--output", "out"]);
    place.succeed(&["run", "two.toml", "--quiet", "--output", "half", "--until", "0.25"]);
    std::fs::create_dir(place.path("moved")).unwrap();
    std::fs::rename(place.path("tet.inp"), place.path("moved/tet.inp")).unwrap();
    let lost = place.emmy(&["resume", "half", "--quiet", "--until", "0.5"]);
    assert!(lost.code != 0 && lost.stderr.contains("tet.inp"), "{}", lost.stderr);
    let set = ["--set", "mesh.parts.1.file=../moved/tet.inp"];
    place.succeed(&[&["resume", "half", "--quiet", "--until", "0.5"], &set[..]].concat());
    // All columns but the time of computing and the last one.
    let last = |name: &str| {
        let numbers: Vec<String> =
            place.read(name).lines().last().unwrap().split(',').map(String::from).collect();
        numbers[..numbers.len() - 2].to_vec()
    };
    assert_eq!(last("half/history.csv"), last("out/history.csv"));
    // Another content of the file is another body.
    place.write("two.toml", &input.replace("tet.inp", "moved/tet.inp"));
    place.succeed(&["run", "two.toml", "--quiet", "--output", "again", "--until", "0.25"]);
    let text = place.read("moved/tet.inp");
    place.write("moved/tet.inp", &text.replace("4,0,0,1", "4,0,0,1.1"));
    let other = place.emmy(&["resume", "again", "--quiet", "--until", "0.5"]);
    assert!(other.code == 2 && other.stderr.contains("mesh"), "{}", other.stderr);
}

/// The report and the study know the files of parts.
#[test]
fn a_study_keeps_its_reference_for_parts() {
    let place = Place::new();
    place.write(
        "tet.inp",
        "*Node\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*Element, type=C3D4, elset=tet\n1, 1,2,3,4\n",
    );
    let input = format!(
        "[mesh]\nparts = [{{ name = 'a', file = 'tet.inp' }}]\n[[region]]\ndensity = 2\nmaterial.neo-hooke = {{ lambda = \
         1000, mu = 500 }}\n[initial]\ngradient = [[0.3, 0, 0], [0, 0, 0], [0, 0, 0]]\n{TIME}"
    );
    place.write("one.toml", &input);
    let study = ["converge", "one.toml", "--sizes", "0.1,0.05", "--quiet", "--output", "study"];
    place.succeed(&study);
    assert_eq!(place.names("study/reference").len(), 1);
    place.write("tet.inp", &place.read("tet.inp").replace("4,0,0,1", "4,0,0,1.1"));
    place.succeed(&study);
    assert_eq!(place.names("study/reference").len(), 2);
}

#[test]
fn the_list_of_meshes_has_parts_and_round_shapes() {
    let list = Place::new().succeed(&["list", "meshes"]).stdout;
    for part in
        ["ring", "cylinder", "ball", "parts", "keys name, l-block, box", "keys inner, outer, height, cells"]
    {
        assert!(list.contains(part), "{part}\n{list}");
    }
}
