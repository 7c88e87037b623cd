//! `emmy report --pictures`: pictures of the extremes.

use super::{BOX, Place};

/// The box, pushed and let go, with the largest values of every step.
fn pushed() -> String {
    BOX.replacen("[[0.0, 0.0], [0.5, 1.0]]", "[[0.0, 0.0], [0.2, 1.0], [0.21, 0.0]]", 1).replacen(
        "every = 2",
        "every = 1\nextremes = [\"von_mises_stress\", \"displacement\"]",
        1,
    )
}

/// Width and height in the header of a PNG.
fn size(place: &Place, file: &str) -> [u32; 2] {
    let bytes = std::fs::read(place.path(file)).unwrap();
    assert_eq!(bytes[..8], *b"\x89PNG\r\n\x1a\n", "{file}");
    [16, 20].map(|at| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()))
}

/// Files of pictures of a run with the default fields.
const FILES: [&str; 9] = [
    "displacement.png",
    "extremes.csv",
    "largest_stretch.png",
    "mean_stress.png",
    "smallest_stretch.png",
    "speed.png",
    "start.png",
    "strain_energy_density.png",
    "von_mises_stress.png",
];

/// The history has the largest values of all nodes, computed elsewhere and at other times than the pictures.
#[test]
fn pictures_show_the_frames_of_the_largest_values() {
    let place = Place::with(&pushed());
    place.succeed(&["run", "box.toml", "--quiet"]);
    std::fs::remove_file(place.path("out/report.html")).unwrap();
    let outcome = place.succeed(&["report", "out", "--pictures"]);
    let mut paths: Vec<&str> = outcome.stdout.lines().collect();
    assert_eq!(paths.remove(0), "out/report.html");
    paths.sort_unstable();
    let pictures = FILES.into_iter().filter(|file| file.ends_with(".png"));
    assert_eq!(paths, pictures.map(|file| format!("out/pictures/{file}")).collect::<Vec<_>>());
    assert!(place.path("out/report.html").exists() && place.names("out/pictures") == FILES);
    // The view of a box that is twice as long as high and wide needs the whole height.
    paths.iter().for_each(|path| assert_eq!(size(&place, path), [1600, 1200], "{path}"));
    let history = place.history("out");
    let table = place.read("out/pictures/extremes.csv");
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows[0], ["picture", "field", "extreme", "time", "value", "x", "y", "z", "X", "Y", "Z"]);
    assert_eq!(rows.len(), FILES.len() - 1);
    let row = |field: &str| -> Vec<f64> {
        let row = rows.iter().find(|row| row[1] == field).unwrap();
        assert_eq!(row[0], format!("{field}.png"));
        row[3..].iter().map(|number| number.parse().unwrap()).collect()
    };
    for field in ["displacement", "von_mises_stress"] {
        let column = &history[&format!("max_{field}")];
        let largest = (0..column.len()).max_by(|&a, &b| column[a].total_cmp(&column[b])).unwrap();
        // Otherwise the first or the last frame would pass, too.
        assert!(largest > 0 && largest + 1 < column.len(), "{column:?}");
        let own = row(field);
        assert_eq!(own[0], history["time"][largest], "{field}");
        assert!((own[1] / column[largest] - 1.0).abs() < 1e-12, "{field}: {own:?} {}", column[largest]);
    }
    // The place is that of a corner, displaced by the value.
    let displaced = row("displacement");
    let [moved, corner] = [2, 5].map(|at| [displaced[at], displaced[at + 1], displaced[at + 2]]);
    assert!(
        corner[1] == 2.0 && [corner[0], corner[2]].iter().all(|x| [0.0, 1.0].contains(x)),
        "{displaced:?}"
    );
    let distance = (0..3).map(|i| (moved[i] - corner[i]).powi(2)).sum::<f64>().sqrt();
    assert!((distance - displaced[1]).abs() < 1e-12, "{displaced:?}");
    assert!(row("smallest_stretch")[1] < 1.0 && row("largest_stretch")[1] > 1.0);
    // Again, and from frames in one file, they are the same byte for byte.
    place.succeed(&["run", "box.toml", "--quiet", "--output", "one", "--set", "output.format=vtkhdf"]);
    place.succeed(&["report", "one", "--pictures"]);
    place.write("out/pictures/start.png", "an earlier one");
    place.succeed(&["report", "out", "--pictures"]);
    for file in FILES {
        let [many, one] =
            ["out", "one"].map(|name| std::fs::read(place.path(&format!("{name}/pictures/{file}"))).unwrap());
        assert!(many == one, "{file}");
    }
}

#[test]
fn without_frames_or_displacements_nothing_is_written() {
    let place = Place::with(BOX);
    for (set, cause, remedy) in [
        (&["output.every=0"][..], "out can be drawn: there are no frames", "output.every"),
        (&["output.fields=['velocity']"], "the frames have no displacement", "output.fields"),
        (
            &["output.fields=['velocity']", "output.format=vtkhdf"],
            "the frames have no displacement",
            "output.fields",
        ),
    ] {
        let set: Vec<&str> = set.iter().flat_map(|set| ["--set", set]).collect();
        place.succeed(&[&["run", "box.toml", "--quiet"][..], &set].concat());
        std::fs::remove_file(place.path("out/report.html")).unwrap();
        let outcome = place.emmy(&["report", "out", "--pictures"]);
        let has = |part: &str| outcome.stderr.split_whitespace().collect::<Vec<_>>().join(" ").contains(part);
        assert!(outcome.code == 2 && has(cause) && has(remedy), "{set:?} {}", outcome.stderr);
        assert!(!place.path("out/report.html").exists() && !place.path("out/pictures").exists());
        // The page does not need them.
        place.succeed(&["report", "out"]);
    }
    for (directory, message) in [(".", "no run of Emmy"), ("nothing", "not a directory")] {
        let outcome = place.emmy(&["report", directory, "--pictures"]);
        assert!(outcome.code == 2 && outcome.stderr.contains(message), "{}", outcome.stderr);
    }
}

#[test]
fn pictures_do_not_outlive_their_frames() {
    let place = Place::with(BOX);
    place.succeed(&["run", "box.toml", "--quiet", "--until", "0.2"]);
    place.succeed(&["report", "out", "--pictures"]);
    place.succeed(&["resume", "out", "--quiet", "--until", "0.5"]);
    assert!(!place.path("out/pictures").exists());
    place.succeed(&["report", "out", "--pictures"]);
    place.write("out/pictures/mine.png", "");
    place.succeed(&["run", "box.toml", "--quiet", "--set", "output.fields=['displacement']"]);
    assert_eq!(place.names("out/pictures"), ["mine.png"]);
    // A picture that the frames do not have any more goes, others stay.
    place.write("out/pictures/speed.png", "of another program that wrote frames");
    place.succeed(&["report", "out", "--pictures"]);
    assert_eq!(place.names("out/pictures"), ["displacement.png", "extremes.csv", "mine.png", "start.png"]);
}

#[test]
fn natural_modes_have_a_picture_each() {
    let place = Place::with(BOX);
    place.succeed(&["modes", "box.toml", "--count", "3", "--output", "modes", "--quiet"]);
    let outcome = place.succeed(&["report", "modes", "--pictures"]);
    let expected = "modes/report.html\nmodes/pictures/mode-1.png\nmodes/pictures/mode-2.png\nmodes/pictures/mode-3.png\n";
    assert_eq!(outcome.stdout, expected);
    assert_eq!(size(&place, "modes/pictures/mode-3.png"), [1600, 1200]);
    place.succeed(&["modes", "box.toml", "--count", "2", "--output", "modes", "--quiet"]);
    assert!(!place.path("modes/pictures").exists());
}
