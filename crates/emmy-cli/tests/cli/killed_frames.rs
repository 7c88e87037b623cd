//! Frames of runs that are killed and resumed equal the frames of an uninterrupted run, in either format.

use std::time::Duration;

use emmy_io::vtk::SeriesReader;

use super::Place;
use super::resume::{even_box, frames, start, wait_for_rows};

/// A box with a frame per step, and some checkpoints.
fn filmed_box(format: &str) -> String {
    let output = format!("every = 1\ncheckpoint_every = 20\nformat = \"{format}\"");
    even_box(1.6, 0.002).replace("every = 2", &output)
}

fn times(place: &Place, format: &str, directory: &str) -> Vec<String> {
    match format {
        "vtu" => frames(place, directory),
        _ => {
            let series = SeriesReader::open(&place.path(&format!("{directory}/{directory}.vtkhdf"))).unwrap();
            series.times().iter().map(|time| format!("{time:?}")).collect()
        }
    }
}

#[test]
fn a_run_that_is_killed_has_every_frame_once_it_is_resumed() {
    for format in ["vtu", "vtkhdf"] {
        let place = Place::with(&filmed_box(format));
        place.succeed(&["run", "box.toml", "--quiet", "--output", "whole"]);
        let expected = times(&place, format, "whole");
        assert_eq!(expected.len(), 801);
        let mut run = start(&place, &["run", "box.toml"]);
        for n_rows in [90, 170, 290, 410, 530] {
            wait_for_rows(&place, "out", n_rows);
            run.kill().unwrap();
            run.wait().unwrap();
            run = start(&place, &["resume", "out"]);
        }
        // Also while the earlier frames are copied.
        std::thread::sleep(Duration::from_millis(30));
        run.kill().unwrap();
        run.wait().unwrap();
        place.succeed(&["resume", "out", "--quiet"]);
        assert_eq!(times(&place, format, "out"), expected, "{format}");
        assert!(!place.read("out/events.csv").contains("lost-frames"));
        let left: Vec<String> = place.names("out");
        assert!(left.iter().all(|name| !name.ends_with(".part") && !name.ends_with(".journal")), "{left:?}");
    }
}

#[test]
fn frames_that_are_lost_are_told() {
    for (format, file) in [("vtu", "frames/out_000003.vtu"), ("vtkhdf", "out.vtkhdf")] {
        let place = Place::with(
            &even_box(0.3, 0.05).replace("every = 2", &format!("every = 1\nformat = \"{format}\"")),
        );
        place.succeed(&["run", "box.toml", "--quiet"]);
        std::fs::remove_file(place.path(&format!("out/{file}"))).unwrap();
        let outcome = place.succeed(&["resume", "out", "--quiet", "--until", "0.5"]);
        let says =
            if format == "vtu" { "the frame of step 3, t = 0.15" } else { "7 frames from t = 0 to t = 0.3" };
        for text in [outcome.stderr, place.read("out/events.csv"), place.read("out/run.log")] {
            assert!(text.contains(says), "{text}");
        }
        assert!(place.read("out/events.csv").contains(",lost-frames,"));
        assert_eq!(times(&place, format, "out").len(), if format == "vtu" { 10 } else { 4 });
    }
}
