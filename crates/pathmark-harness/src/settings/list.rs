//! The list of settings: what tells one run from another, each once.
//!
//! An entry is
//!
//! ```text
//! /// The meaning of its column.
//! PLACE NAME: TYPE = DEFAULT, PROPERTIES;
//! ```
//!
//! A new setting is one entry here and the code that uses its value; a setting of the renderer is also a field of
//! [`Spec`](crate::kernel::Spec). From the list follow [`Settings`](super::Settings), the columns of a row, the keys of
//! images, schedules and films, and the table [`SETTINGS`](super::SETTINGS), by which the command line, the matrix of
//! an experiment, filters, cell ids and the labels of figures know it.
//!
//! | place | value |
//! |--|--|
//! | `own` | a field of `Settings`, with a default |
//! | `spec` | a field of its `spec` |
//! | `found` | what nobody asks for and a setup finds out: a second column of the entry above |
//!
//! | group | another value |
//! |--|--|
//! | `image` | gives another image |
//! | `schedule` | must not change a bit of the image |
//!
//! Keys compare their columns in this order.

/// Calls the macro with `CONTEXT image { ENTRIES } schedule { ENTRIES }`.
macro_rules! settings_list {
    ($callback:ident $context:tt) => { $callback! { $context
        image {
            /// Name of the scene or workload.
            own scene: String = "cornell".to_string(), Setting { nested: 0, word: "{}", label: "{}", all: Some(Setting::scenes), ..Setting::NEW };
            /// Hash of the scene's definition: two files may have the same name, and one may be edited between two runs.
            found scene_hash: String, Setting { is_part: true, word: "-{}", ..Setting::NEW };
            /// Name of the estimator.
            spec estimator: String, Setting { nested: 2, of_light: true, word: "/{}", label: "{}",
                value_name: "NAME", about: "Estimator: one of `pathmark list estimators` [default: the scene's own]", ..Setting::NEW };
            /// Name of the sampler.
            spec sampler: String, Setting { nested: 3, of_light: true, word: "/{}", label: "{}",
                value_name: "NAME", about: "Sampler, the source of random numbers: one of `pathmark list samplers`", default: "independent", ..Setting::NEW };
            /// Width of the image in pixels.
            spec width: u32, Setting { nested: 1, name: "size", word: "/{}", label: "{}",
                value_name: "WxH", about: "Width and height in pixels", default: "512x384", ..Setting::NEW };
            /// Height of the image in pixels.
            spec height: u32, Setting { is_part: true, word: "x{}", ..Setting::NEW };
            /// Samples per pixel.
            own spp: u32 = 16, Setting { nested: 6, word: "/{}spp", ..Setting::NEW };
            /// Seed of the sampler.
            spec seed: u64, Setting { nested: 8, word: "/seed{}", ..Setting::NEW };
            /// Bounces after which paths were cut; empty if there was no limit.
            spec max_depth: Option<u16>, Setting { nested: 4, of_light: true, word: "/depth{}", label: "depth {}",
                value_name: "N", about: "Cut paths after N bounces; 0 keeps only directly visible light [default: the estimator's own limit, if it has one]", ..Setting::NEW };
            /// Camera rays per sample; empty for one.
            spec camera_rays: Option<u16>, Setting { nested: 5, of_light: true, word: "/{}rays", label: "{} camera rays", absent: "one camera ray",
                value_name: "N", about: "Camera rays per sample: their directly visible light is averaged, and the path continues from one of them [default: 1]", ..Setting::NEW };
            /// Russian roulette rule; empty if there was none.
            spec roulette: Option<String>, Setting { nested: 17, of_light: true, label: "{}",
                value_name: "RULE", about: "Russian roulette rule: albedo:N or throughput:N after the N-th vertex, constant:P, or never [default: the estimator's own]", ..Setting::NEW };
            /// Clamp: `subpixel` or `recursion`, followed by a colon and its limit if that is not 1; empty if there was none.
            spec clamp: Option<String>, Setting { nested: 9, of_light: true, label: "{}", ..Setting::NEW };
            /// Pixel filter; empty if it was the camera's own.
            spec filter: Option<String>, Setting { nested: 10, of_light: true, label: "filter {}", absent: "own filter", all: Some(Setting::filters),
                value_name: "NAME", about: "Pixel filter: one of `pathmark list filters` [default: the camera's own]", ..Setting::NEW };
            /// Distance below which hits were dropped; empty if there was none.
            spec epsilon: Option<String>, Setting { nested: 11, of_light: true, label: "epsilon {}", absent: "no epsilon",
                value_name: "DISTANCE", about: "Drop hits nearer than DISTANCE, as some programs do to exclude the surface where a ray starts: biased, scalar kernel only [default: none needed]", ..Setting::NEW };
            /// Floating-point format of the kernel that rendered: `f64` or `f32`.
            spec precision: String, Setting { nested: 14, of_light: true, word: "/{}", label: "{}",
                value_name: "FORMAT", about: "Floating-point format: f64, or f32, which produces different bits and does not work with the scalar kernel", default: "f64", ..Setting::NEW },
                read serde(default = "double");
            /// Whether the noise of each tile determined its number of samples; `spp` is then their mean.
            own adaptive: bool = false, Setting { nested: 7, of_light: true, word: "/adaptive", label: "adaptive", absent: "even", ..Setting::NEW },
                read serde(default);
            /// Seconds of rendering after which the render was to stop: `spp` are then the samples that it reached. Empty without
            /// a limit.
            own time_limit_s: Option<crate::settings::Seconds> = None, Setting { name: "time-limit", nested: 27, word: "/for-{}s", label: "for {} s", absent: "without a time limit", ..Setting::NEW };
            /// A setting that nothing uses, for tests of the list.
            own test_knob: Option<u16> = None, Setting { nested: 24, label: "knob {}", absent: "no knob",
                value_name: "N", about: "Knob of tests", ..Setting::NEW },
                when cfg(test);
        }
        schedule {
            /// Name of the scheduling strategy; with several processes, the strategy within each.
            own strategy: String = "work-stealing".to_string(), Setting { nested: 18, word: "/{}", all: Some(Setting::strategies),
                value_name: "NAME", about: "Scheduling strategy: one of `pathmark list strategies`, or thread-per-row", default: "work-stealing", ..Setting::NEW };
            /// Decomposition: how the film was cut into pieces.
            own decomposition: String = "tiles:32x32".to_string(), Setting { nested: 20, word: "/{}", label: "{}",
                value_name: "CUT", about: "Decomposition into pieces: rows, bands:N, grid:N, tiles:WxH[:hilbert|:spiral|:cost], `samples:B[:WxH]` [default: tiles:32x32]", ..Setting::NEW };
            /// Requested threads; with several processes, in each.
            own threads: usize = available_threads(), Setting { nested: 19, word: "/{}t",
                value_name: "N", about: "Worker threads [default: one per processor]", ..Setting::NEW };
            /// Number of processes connected by MPI; empty if there was one process.
            own ranks: Option<u16> = None, Setting { nested: 23, word: "/{}ranks", ..Setting::NEW };
            /// Rule by which the processes shared the jobs; empty if there was one process.
            own rank_rule: Option<String> = None, Setting { nested: 22, word: "/{}", ..Setting::NEW };
            /// Output: how workers delivered pieces to the film.
            own output: String = "slots".to_string(), Setting { nested: 21, word: "/{}", label: "{}",
                value_name: "NAME", about: "How workers deliver pieces to the film: one of `pathmark list outputs`", default: "slots", ..Setting::NEW };
            /// Name of the kernel that rendered, such as `scalar` or `lanes`.
            spec kernel: String, Setting { nested: 12, of_light: true,
                value_name: "NAME", about: "Kernel: lanes, scalar, device, or device:ID for a device of `pathmark list devices`", default: "lanes", ..Setting::NEW };
            /// Why the requested kernel could not render; empty if it did.
            found kernel_fallback: Option<String>, Setting { is_part: true, word: "/fallback", ..Setting::NEW };
            /// Instruction set of the lanes; empty for kernels without lanes.
            spec simd: Option<String>, Setting { nested: 13, of_light: true, all: Some(Setting::levels),
                value_name: "LEVEL", about: "Instruction set of lanes: one of `pathmark list simd` [default: the fastest that this processor supports]", ..Setting::NEW };
            /// Effect profile of the kernel.
            spec effects: Option<String>, Setting { nested: 15, of_light: true, label: "{}",
                value_name: "PROFILE", about: "Effect profile: one of `pathmark list effects` [default: the smallest that covers the scene]", ..Setting::NEW };
            /// Acceleration structure: `none`, `median` or `sah`.
            spec accelerator: Option<String>, Setting { nested: 16, of_light: true, label: "{}",
                value_name: "NAME", about: "Acceleration structure: one of `pathmark list accelerators` [default: chosen by the number of primitives]", ..Setting::NEW };
            /// Policy by which each worker was pinned to a processor; empty if workers were not pinned.
            own pin: crate::machine::PinPolicy = crate::machine::PinPolicy::None, Setting { nested: 25, label: "pin {}", absent: "not pinned",
                value_name: "POLICY", about: "Pin each worker to a processor: none, compact, scatter, one-per-core, performance, or a list such as 0-3,8", default: "none", ..Setting::NEW },
                read serde(default);
            /// Whether the processor's counters were read.
            own counters: bool = false, Setting { nested: 26, word: "/counters", label: "with counters", absent: "without counters",
                value_name: "BOOL", about: "Read the processor's counters (cycles, instructions, misses), which makes the start of threads slower [default: false]", ..Setting::NEW },
                read serde(default);
        }
    } };
}
pub(crate) use settings_list;
