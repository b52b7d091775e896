//! `pathmark image compare IMAGE REFERENCE [HALF]`: the error of an image against another, or against two references without
//! their noise.

use super::{is_film, read_picture};
use crate::analysis::Interval;
use crate::analysis::mean::t_interval;
use crate::film_file::FilmKey;
use crate::image_io::{self, Image};
use crate::metric::{METRICS, cross_products, cross_rel_mse, flip_map, heatmap, root};
use crate::verbs::prelude::*;

/// Confidence of the cross form's interval.
const LEVEL: f64 = 0.95;

/// `pathmark image compare box.pfm reference.exr --heatmap error.png`
#[derive(Args)]
pub(crate) struct Arguments {
    /// The image: a picture or a film file
    image: PathBuf,
    /// The reference: a picture or a film file
    reference: PathBuf,
    /// A second reference that shares no samples with the first, as `pathmark image reference` makes them: the error then excludes their noise, and has
    /// an interval
    half: Option<PathBuf>,
    /// Write a picture of each pixel's error
    #[arg(long, value_name = "FILE.png")]
    heatmap: Option<PathBuf>,
    /// Error that the heat map shows in its lightest colour [default: the error that 1 % of the pixels exceed]
    #[arg(long, value_name = "ERROR", requires = "heatmap")]
    scale: Option<f64>,
    /// Write a picture of each pixel's visible difference: FLIP, from 0 to 1
    #[arg(long, value_name = "FILE.png")]
    flip: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Finds images of one scene and one seed, which share samples and look more alike than they are. Refuses such films,
/// because films serve to measure errors. Returns a remark about such pictures, which may be two ways to render one
/// image.
fn shared_samples(inputs: &[(&PathBuf, Option<FilmKey>)]) -> Result<Option<String>> {
    let mut remark = None;
    for (index, (path, key)) in inputs.iter().enumerate() {
        for (other_path, other) in &inputs[..index] {
            let (Some(key), Some(other)) = (key, other) else { continue };
            if (&key.scene_hash, key.seed) != (&other.scene_hash, other.seed) {
                continue;
            }
            let problem = "is the seed of both images, so they share samples and look more alike than they are";
            if is_film(path) && is_film(other_path) {
                return Err(InputError::new("seed", key.seed.to_string(), problem)
                    .allowed("two different seeds")
                    .into());
            }
            remark = Some(format!("seed {} {problem}", key.seed));
        }
    }
    Ok(remark)
}

struct Line {
    name: &'static str,
    value: f64,
    interval: Option<Interval>,
    about: &'static str,
}

pub(super) fn run(arguments: &Arguments) -> Result<()> {
    if let Some(scale) = arguments.scale.filter(|scale| !(*scale > 0.0 && scale.is_finite())) {
        let error = InputError::new("scale", scale.to_string(), "must be a positive number");
        return Err(error.allowed("an error of linear radiance, such as 0.5").into());
    }
    let inputs = [Some(&arguments.image), Some(&arguments.reference), arguments.half.as_ref()];
    let names = ["the image", "the reference", "the second reference"];
    let maps = [("heatmap", arguments.heatmap.as_ref()), ("flip", arguments.flip.as_ref())];
    let mut files = Files::default();
    for (name, input) in names.into_iter().zip(inputs) {
        if let Some(input) = input {
            files.reads(name, input);
        }
    }
    for (option, path) in maps.into_iter().filter_map(|(option, path)| Some((option, path?))) {
        image_io::check_format(path)?;
        files.writes(option, path)?;
    }
    let (mut read, mut shown) = (Vec::new(), Vec::new());
    for path in inputs.into_iter().flatten() {
        let (image, film) = read_picture(path)?;
        shown.push((path, film.map(|film| film.key)));
        read.push(image);
    }
    let shared = shared_samples(&shown)?;
    let images: Vec<&Image> = read.iter().collect();
    let lines = match images[..] {
        [image, first, second] => cross(image, first, second)?,
        [image, reference, ..] => plain(image, reference)?,
        _ => Vec::new(),
    };
    let shares_samples = shared.is_some();
    let mut remarks: Vec<String> = shared.into_iter().collect();
    for (option, path) in maps {
        let Some(path) = path else { continue };
        let map = match option {
            "flip" => flip_map(images[0], images[1])?.1,
            _ => heatmap(images[0], images[1], arguments.scale)?,
        };
        image_io::write(path, &map.to_image())?;
        remarks.push(format!("{}: from 0 (dark) to {:.4} (light)", path.display(), map.scale));
    }
    if arguments.json {
        let mut told = object(&lines);
        told.insert("shares_samples".to_string(), shares_samples.into());
        print_json(&told)?;
        return check_finite(&shown, &read);
    }
    let width = lines.iter().map(|line| line.name.len()).max().unwrap_or(0);
    let line = |Line { name, value, interval, about }: &Line| {
        let between = interval.map_or_else(String::new, |i| format!("({:.6} to {:.6})  ", i.low, i.high));
        format!("{name:width$}  {value:<12.6}  {between}{about}")
    };
    let told: Vec<String> = lines.iter().map(line).chain(remarks).collect();
    print(&told.join("\n"))?;
    check_finite(&shown, &read)
}

/// Fails if a pixel is not a colour, and names the first: metrics that use it are NaN or infinite.
fn check_finite(shown: &[(&PathBuf, Option<FilmKey>)], images: &[Image]) -> Result<()> {
    for ((path, _), image) in shown.iter().zip(images) {
        let mut odd = (0..).zip(&image.pixels).filter(|(_, pixel)| !pixel.iter().all(|value| value.is_finite()));
        let Some((index, [r, g, b])) = odd.next() else { continue };
        let (x, y) = (index % image.width, index / image.width);
        let more = match odd.count() {
            0 => String::new(),
            count => format!(", and {} like it", counted(count, "pixel")),
        };
        let problem = format!("{}: pixel ({x}, {y}) = ({r}, {g}, {b}) is not finite{more}", path.display());
        return Err(Error::Check(problem));
    }
    Ok(())
}

/// Every metric against one reference.
fn plain(image: &Image, reference: &Image) -> Result<Vec<Line>> {
    let line = |metric: &'static crate::metric::Entry| {
        let value = metric.compute(image, reference)?;
        Ok(Line { name: metric.name, value, interval: None, about: metric.about })
    };
    METRICS.iter().map(line).collect()
}

/// The cross form, with an interval from the scatter of the pixels' products. The noise of neighbours is independent;
/// other differences between pixels only make the interval wider.
fn cross(image: &Image, first: &Image, second: &Image) -> Result<Vec<Line>> {
    let products = cross_products(image, first, second)?;
    let mean = products.iter().sum::<f64>() / products.len() as f64;
    let interval = t_interval(&products, LEVEL).map(|estimate| estimate.interval);
    let rmse = root(mean).unwrap_or(f64::NAN);
    let of_roots = |i: Interval| Interval { low: i.low.max(0.0).sqrt(), high: i.high.max(0.0).sqrt(), level: i.level };
    let rel_mse = cross_rel_mse(image, first, second)?;
    Ok(vec![
        Line { name: "mse", value: mean, interval, about: "mean squared error, free of the references' noise (95 %)" },
        Line { name: "rmse", value: rmse, interval: interval.map(of_roots), about: "root of mse; NaN if negative" },
        Line {
            name: "rel-mse",
            value: rel_mse,
            interval: None,
            about: "mse relative to the squared reference, free of the references' noise",
        },
    ])
}

fn object(lines: &[Line]) -> serde_json::Map<String, Value> {
    let mut object = serde_json::Map::new();
    for Line { name, value, interval, .. } in lines {
        object.insert((*name).to_string(), number(*value));
        if let Some(Interval { low, high, .. }) = interval {
            object.insert(format!("{name}_low"), number(*low));
            object.insert(format!("{name}_high"), number(*high));
        }
    }
    object
}
