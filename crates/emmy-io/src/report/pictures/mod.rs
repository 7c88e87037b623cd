//! `pictures/`: the extremes of a run, or natural modes, as PNG.
//!
//! A picture shows the frame in which the largest value of a field over the surface occurs, from the default view of
//! the page. No graphics card is needed.
//!
//! | module | task |
//! |---|---|
//! | `extremes` | the frames with the largest values |
//! | `nodal` | arrays of the frames, at the nodes of the surface |
//! | `camera` | the observer |
//! | `colours` | the colour maps |
//! | `raster` | triangles on a canvas with a depth buffer |
//! | `skin` | the surface on the canvas |
//! | `sheet` | titles, bar, axes |

mod camera;
mod colours;
mod extremes;
mod nodal;
mod raster;
mod sheet;
mod skin;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::collection::{self, FrameSource};
use super::fields::{FIELDS, MOTION};
use super::frames;
use super::run::units;
use super::{ReportError, check, modes};
use crate::comparison;
use crate::input::relation;
use crate::modes::WITNESS;
use crate::picture;
use crate::whole_file::{self, PART, names, remove, replace};
use camera::Camera;
use colours::Scale;
use extremes::Shot;
use nodal::Nodal;
use raster::Canvas;
use sheet::{Key, Sheet};
use skin::{Seen, Skin};

/// Folder of the pictures.
pub(crate) const DIRECTORY: &str = "pictures";

/// Name of the table of the extremes.
const TABLE: &str = "extremes.csv";
/// Name of the picture of the first frame.
const START: &str = "start";
/// Beginning of the names of pictures of natural modes.
const MODE: &str = "mode-";

/// The pictures of a directory, before they are drawn.
#[derive(Debug)]
pub struct Pictures {
    folder: PathBuf,
    /// Title of the run.
    title: String,
    frames: FrameSource,
    nodal: Nodal,
    skin: Skin,
    shots: Vec<Shot>,
    /// Table of the extremes; empty for natural modes.
    table: String,
}

impl Pictures {
    /// Chooses the pictures of a run or of natural modes. Nothing is written.
    ///
    /// # Errors
    /// [`ReportError`], in particular without frames or without displacements in them.
    pub fn find(directory: &Path) -> Result<Self, ReportError> {
        let are_modes = modes::are_in(directory);
        if !are_modes {
            check(directory)?;
        }
        let unfit = |cause, remedy| ReportError::NoPictures { path: directory.to_path_buf(), cause, remedy };
        let no_displacement = || {
            unfit(
                "the frames have no displacement",
                "add \"displacement\" to `output.fields`, and run it again",
            )
        };
        let Some((_, frames)) = FrameSource::find(directory).filter(|(_, frames)| frames.len() > 0) else {
            return Err(match collection::has_series(directory) {
                true => no_displacement(),
                false => unfit(
                    "there are no frames",
                    "set `output.every` (1 or more) or `output.interval`, and run it again",
                ),
            });
        };
        let Some((frame, surface)) = frames::shown(&frames)? else {
            return Err(unfit("the frames have no cells to draw", "rigid bodies alone have no surface"));
        };
        if !frames::has_displacement(&frame) {
            return Err(no_displacement());
        }
        let input = directory.join(if are_modes { WITNESS } else { "input.toml" });
        let input: toml::Table =
            whole_file::read_text(&input).unwrap_or_default().parse().unwrap_or_default();
        let units = units(directory, &input);
        let nodal = Nodal::new(&frame.points, &surface);
        let (shots, table) = if are_modes {
            let frequency = units["system"]["frequency"].as_str().unwrap_or_default();
            (extremes::modes(directory, &frames, &nodal, frequency)?, String::new())
        } else {
            let is_static = comparison::summary(directory)?["scheme"] == "static";
            let fields = frames::present(&frames, &frame)?;
            let relative_to = input.get("output").and_then(|output| output.get("relative_to")?.as_str());
            let words = extremes::Words { units: &units, is_static, relation: relation(relative_to) };
            extremes::of_run(&frames, &fields, &nodal, &words)?
        };
        let title = input.get("title").and_then(toml::Value::as_str).unwrap_or_default().to_string();
        let skin = Skin::new(surface, nodal.points());
        Ok(Pictures { folder: directory.join(DIRECTORY), title, frames, nodal, skin, shots, table })
    }

    /// Draws and writes the pictures, and returns their paths.
    ///
    /// # Errors
    /// [`ReportError`].
    pub fn write(&self) -> Result<Vec<PathBuf>, ReportError> {
        let system = |error| ReportError::System { path: self.folder.clone(), error };
        fs::create_dir_all(&self.folder).map_err(system)?;
        let write = |shot: &Shot| {
            let path = self.folder.join(format!("{}.png", shot.name));
            replace(&path, &self.drawn(shot)?).map_err(ReportError::Page)?;
            Ok(path)
        };
        let paths = self.shots.iter().map(write).collect::<Result<_, ReportError>>()?;
        if !self.table.is_empty() {
            replace(&self.folder.join(TABLE), self.table.as_bytes()).map_err(ReportError::Page)?;
        }
        self.remove_others().map_err(system)?;
        Ok(paths)
    }

    /// Removes pictures of an earlier call that this one does not have.
    fn remove_others(&self) -> io::Result<()> {
        let is_new = |name: &String| {
            let is_shot = |stem: &str| self.shots.iter().any(|shot| shot.name == stem);
            name.strip_suffix(".png").is_some_and(is_shot) || name == TABLE && !self.table.is_empty()
        };
        let all = names(&self.folder)?.into_iter();
        all.filter(|name| is_own(name) && !is_new(name)).try_for_each(|name| remove(&self.folder.join(name)))
    }

    /// A picture as PNG.
    fn drawn(&self, shot: &Shot) -> Result<Vec<u8>, ReportError> {
        let (positions, values) = shot.numbers(&self.frames, &self.nodal)?;
        let reference = self.nodal.points();
        let view = camera::viewpoint(reference, !self.skin.surface().triangles.is_empty());
        // All pictures of a run have the same height.
        let height = sheet::height(camera::height_over_width(&view, reference));
        let camera = Camera::fitted(&view, &positions, sheet::window(height));
        let scale = shot.extreme.as_ref().map(|extreme| Scale::of(&values, extreme.is_signed));
        let mut canvas = Canvas::new(sheet::size(height));
        let values = scale.as_ref().map(|scale| (values.as_slice(), scale));
        self.skin.paint(&mut canvas, Seen { camera: &camera, positions: &positions, values });
        let key = shot.extreme.as_ref().zip(scale.as_ref()).map(|(extreme, scale)| {
            let (place, nearness) = camera.project(positions[extreme.node]);
            Key {
                scale,
                unit: &extreme.unit,
                extreme: (extreme.name, extreme.value),
                mark: (place, canvas.hides(place, nearness)),
            }
        });
        let sheet = Sheet { title: &self.title, caption: &shot.caption, height, axes: camera.axes(), key };
        picture::png_over(&sheet.svg(), canvas.pixels()).map_err(|error| ReportError::System {
            path: self.folder.join(format!("{}.png", shot.name)),
            error,
        })
    }
}

/// Whether a file in [`DIRECTORY`] is one of Emmy's, finished or not.
pub(crate) fn is_own(file: &str) -> bool {
    let whole = file.strip_suffix(PART).unwrap_or(file);
    let is_mode = |name: &str| {
        let number = name.strip_prefix(MODE);
        number.is_some_and(|digits| !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit()))
    };
    let is_picture = |name: &str| {
        name == START || FIELDS.iter().chain([&MOTION]).any(|field| field.name == name) || is_mode(name)
    };
    whole == TABLE || whole.strip_suffix(".png").is_some_and(is_picture)
}

/// Removes the pictures in a folder, and the folder if it is then empty.
///
/// # Errors
/// Errors of the system.
pub(crate) fn remove_all(folder: &Path) -> io::Result<()> {
    if !folder.is_dir() {
        return Ok(());
    }
    for name in names(folder)?.iter().filter(|name| is_own(name)) {
        remove(&folder.join(name))?;
    }
    if names(folder)?.is_empty() { fs::remove_dir(folder) } else { Ok(()) }
}
