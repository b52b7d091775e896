//! Merging of the parts of an image: `pathmark merge PART...`.
//!
//! A part is a checkpoint that names its shard. Parts of samples are subtrees of each pixel's sum, and parts of tiles
//! are pixels. The merged film therefore has the bits of one that was rendered at once, for any order of the parts and
//! any processes that rendered them.

use super::checkpoint::{Header, Part, difference};
use crate::error::{InputError, Result};
use crate::film::{Film, ProgressiveFilm, Shard, ShardCut};
use crate::film_file::FilmKey;
use std::path::{Path, PathBuf};

const MOST_TOLD: usize = 20;

pub struct Merged {
    pub key: FilmKey,
    pub film: Film,
    /// Number of the image's samples that were NaN, infinite or negative.
    pub invalid: u64,
    pub count: u32,
    /// The parts that are missing or not finished, in words; none if the film is the whole image.
    pub missing: Vec<String>,
}

struct Found {
    path: PathBuf,
    header: Header,
    part: Part,
}

impl Found {
    fn of(path: &Path) -> Result<Self> {
        let header = Header::of(path)?;
        let part = header.part.ok_or_else(|| refused(path, "is a checkpoint of a whole image, not of a part"))?;
        if header.samples().is_empty() {
            // Such a file has no pixels, so its length says nothing about the size of the image.
            return Err(refused(path, "contains no samples").allowed("a part that was rendered").into());
        }
        Ok(Self { path: path.to_path_buf(), header, part })
    }

    /// The header of the whole image: all parts of one image share what [`difference`] compares.
    fn whole(&self) -> Header {
        let Part { shard, spp } = self.part;
        let shard = Shard::new(1, shard.count(), shard.cut()).unwrap_or(shard);
        let mut header = self.header.clone();
        (header.film.spp, header.part) = (spp, Some(Part { shard, spp }));
        header
    }

    /// The samples that it still lacks, in words; `None` if it is complete.
    fn lack(&self) -> Option<String> {
        let have = self.header.samples().len();
        let want = self.part.shard.samples(self.part.spp).len();
        (have < want).then(|| format!("{}: {have} of {want} samples in {}", self.part.shard, self.path.display()))
    }
}

fn refused(path: &Path, problem: &str) -> InputError {
    InputError::new("part", path.display().to_string(), problem)
}

/// Merges parts. Refuses parts of different images, one part in two files, and, unless `partial`, an incomplete image.
pub fn merge(paths: &[PathBuf], partial: bool) -> Result<Merged> {
    let mut parts = paths.iter().map(|path| Found::of(path)).collect::<Result<Vec<_>>>()?;
    parts.sort_by_key(|found| found.part.shard.index());
    let Some(first) = parts.first() else {
        return Err(InputError::new("part", "", "there are no parts to merge").into());
    };
    for found in &parts[1..] {
        if let Some(difference) = difference(&found.whole(), &first.whole()) {
            let problem = format!("does not belong to {}: {difference}", first.path.display());
            return Err(refused(&found.path, &problem).allowed("parts of one image").into());
        }
    }
    if let Some(pair) = parts.windows(2).find(|pair| pair[0].part.shard == pair[1].part.shard) {
        let problem = format!("is part {}, the same as {}", pair[1].part.shard, pair[0].path.display());
        return Err(refused(&pair[1].path, &problem).allowed("each part once").into());
    }
    let (count, cut, spp) = (first.part.shard.count(), first.part.shard.cut(), first.part.spp);
    let missing = missing(&parts, count);
    if !missing.is_empty() && !partial {
        let problem = format!("of the image's {count} parts, some are missing or not finished: {}", missing.join(", "));
        let allowed = "all parts, or --partial for an image of the available samples";
        return Err(InputError::new("part", first.path.display().to_string(), problem).allowed(allowed).into());
    }
    let key = FilmKey { spp, ..first.header.film.clone() };
    let (mut film, mut growing) =
        (Film::try_new(key.width, key.height)?, ProgressiveFilm::new(key.width, key.height, 0));
    let mut invalid = 0;
    for found in &parts {
        let (header, part) = Header::read(&found.path)?;
        if header != found.header {
            return Err(refused(&found.path, "changed while it was being read").into());
        }
        invalid += header.history.counts().invalid;
        match cut {
            ShardCut::Tiles => film.take(&part.film(), |x, y| found.part.shard.owns(x, y)),
            // If samples are missing in between, there is no whole sum whose bits it could have.
            ShardCut::Samples if !missing.is_empty() => film = film.plus(&part.film()),
            ShardCut::Samples => {
                part.into_parts().into_iter().for_each(|(samples, subtree)| growing.add(samples, subtree));
            }
        }
    }
    if cut == ShardCut::Samples && missing.is_empty() {
        film = growing.film();
    }
    Ok(Merged { key, film, invalid, count, missing })
}

fn missing(parts: &[Found], count: u32) -> Vec<String> {
    let mut missing = Vec::new();
    let mut found = parts.iter().peekable();
    for index in 1..=count {
        match found.next_if(|found| found.part.shard.index() == index) {
            Some(found) => missing.extend(found.lack()),
            None => missing.push(format!("{index}/{count}")),
        }
        if missing.len() > MOST_TOLD {
            missing.push("and more".to_string());
            break;
        }
    }
    missing
}
