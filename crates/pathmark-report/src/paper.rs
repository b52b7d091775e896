//! A draft of a paper in LaTeX: for each experiment its question, method, findings, figures and a table with intervals,
//! and at the end the sources of the rules that were applied.

use super::block::Block;
use super::latex::{escaped, prose, tabular};
use super::results::Results;
use super::words::counted;
use crate::analysis::confidence_sequence::Stopping;
use crate::analysis::mse::{Method, over_seeds};
use crate::estimated::LEVEL;
use crate::rows::{group, values};
use crate::table::Table;
use std::collections::BTreeSet;

/// Most rows of a table; the others are in its CSV file.
const MOST_ROWS: usize = 25;

/// A rule with a source.
struct Rule {
    applies: fn(&Results) -> bool,
    /// The sentence that cites it.
    sentence: &'static str,
    /// Its sources, by key.
    sources: &'static [(&'static str, &'static str)],
}

const RULES: [Rule; 5] = [
    Rule {
        applies: |results| results.stopping() == Stopping::Sequential,
        sentence: "Intervals decided when repetitions stopped, so those of medians hold at every look~\\cite{robbins1970,howard2022}.",
        sources: &[
            (
                "robbins1970",
                "H. Robbins. Statistical methods related to the law of the iterated logarithm. Annals of Mathematical Statistics 41(5), 1970.",
            ),
            (
                "howard2022",
                "S. R. Howard and A. Ramdas. Sequential estimation of quantiles with applications to A/B testing and best-arm identification. Bernoulli 28(3), 2022.",
            ),
        ],
    },
    Rule {
        applies: |results| draws(results, "speedup"),
        sentence: "The serial fraction follows Karp and Flatt~\\cite{karp1990}.",
        sources: &[(
            "karp1990",
            "A. H. Karp and H. P. Flatt. Measuring parallel processor performance. Communications of the ACM 33(5), 1990.",
        )],
    },
    Rule {
        applies: |results| draws(results, "scaling-laws"),
        sentence: "We fitted Amdahl's law~\\cite{amdahl1967} and the Universal Scalability Law~\\cite{gunther1993}.",
        sources: &[
            (
                "amdahl1967",
                "G. M. Amdahl. Validity of the single processor approach to achieving large scale computing capabilities. AFIPS, 1967.",
            ),
            (
                "gunther1993",
                "N. J. Gunther. A simple capacity model of massively parallel transaction systems. CMG, 1993.",
            ),
        ],
    },
    Rule {
        applies: |results| draws(results, "weak-scaling"),
        sentence: "Scaled speedups are compared with Gustafson's law~\\cite{gustafson1988}.",
        sources: &[(
            "gustafson1988",
            "J. L. Gustafson. Reevaluating Amdahl's law. Communications of the ACM 31(5), 1988.",
        )],
    },
    Rule {
        applies: has_skewed_errors,
        sentence: "Where the squared errors of seeds vary strongly, the interval of their mean is that of a log-normal mean~\\cite{olsson2005}.",
        sources: &[(
            "olsson2005",
            "U. Olsson. Confidence intervals for the mean of a log-normal distribution. Journal of Statistics Education 13, 2005.",
        )],
    },
];

/// An experiment of the paper.
pub(super) struct Part {
    pub(super) results: Results,
    pub(super) blocks: Vec<Block>,
}

fn draws(results: &Results, figure: &str) -> bool {
    results.definition.figures.iter().any(|name| name == figure)
}

/// Whether the errors of an image vary so much between seeds that their interval is that of a log-normal mean.
fn has_skewed_errors(results: &Results) -> bool {
    let images = group(results.rows().filter(|row| row.mse.is_some()), |row| row.image.without_seed());
    images.into_values().any(|rows| {
        let seeds = group(rows, |row| row.seed).into_values().map(|rows| rows[0]);
        over_seeds(&values(seeds, |row| row.mse), LEVEL).is_some_and(|error| error.method == Method::LogNormal)
    })
}

/// The paper. `folder` is the way from the paper's folder to that of the experiments.
pub(super) fn text(parts: &[Part], folder: &str) -> String {
    let title = match parts {
        [only] => prose(&only.results.definition.title),
        _ => "Title".to_string(),
    };
    let mut applied: Vec<&Rule> = Vec::new();
    let mut body = String::new();
    for part in parts {
        let rules: Vec<&Rule> = RULES.iter().filter(|rule| (rule.applies)(&part.results)).collect();
        body.push_str(&section(part, &rules));
        applied.extend(rules);
    }
    let mut known = BTreeSet::new();
    let sources = applied.iter().flat_map(|rule| rule.sources).filter(|(key, _)| known.insert(*key));
    let sources: Vec<String> =
        sources.map(|(key, source)| format!("\\bibitem{{{key}}} {}\n", escaped(source))).collect();
    let sources = sources.concat();
    let program = format!("\\bibitem{{pathmark}} The Pathmark authors. Pathmark {}.\n", env!("CARGO_PKG_VERSION"));
    format!(
        "% A draft by Pathmark. It is yours to edit: Pathmark replaces no paper.
% LaTeX takes the PDF of a figure if there is one, otherwise its PNG file. For the SVG files as PDF, run in a folder of figures:
%   for f in *.svg; do rsvg-convert -f pdf -o \"${{f%.svg}}.pdf\" \"$f\"; done
\\documentclass{{article}}
\\usepackage[T1]{{fontenc}}
\\usepackage{{booktabs,graphicx}}
\\DeclareGraphicsExtensions{{.pdf,.png}}
\\newcommand{{\\results}}{{{folder}}}
\\title{{{title}}}
\\author{{Author}}
\\begin{{document}}
\\maketitle
{body}
\\begin{{thebibliography}}{{9}}
{program}{sources}\\end{{thebibliography}}
\\end{{document}}
"
    )
}

fn section(part: &Part, rules: &[&Rule]) -> String {
    let Part { results, blocks } = part;
    let definition = &results.definition;
    let rules: Vec<&str> = rules.iter().map(|rule| rule.sentence).collect();
    let findings: Vec<String> = blocks.iter().filter_map(Block::as_finding).map(prose).collect();
    let figures: String = blocks.iter().filter_map(|block| figure(&definition.name, block)).collect();
    let with_interval = blocks.iter().find_map(|block| match block {
        Block::Table { stem, table } if table.has_intervals() => Some(table_of(&definition.name, stem, table)),
        _ => None,
    });
    format!(
        "\n\\section{{{}}}\n{}\n\n\\subsection*{{Method}}\n{}\n{}\n\n\\subsection*{{Results}}\n{}\n\n{figures}{}",
        prose(&definition.title),
        prose(definition.question.trim()),
        method(results),
        rules.join("\n"),
        findings.join("\n\n"),
        with_interval.unwrap_or_default(),
    )
}

/// Configurations, repetitions and machine, in sentences.
fn method(results: &Results) -> String {
    let rows = || results.rows();
    let cells = rows().map(|row| row.cell.as_str()).collect::<BTreeSet<_>>().len();
    let repetitions = rows().map(|row| row.repetition).collect::<BTreeSet<_>>().len();
    let often = match repetitions {
        0 | 1 => " once each".to_string(),
        several => format!(" in up to {several} repetitions"),
    };
    let machine = &results.run.machine;
    let version = if machine.commit.is_empty() { String::new() } else { format!(", commit {}", machine.commit) };
    let (version, machine) = (escaped(&version), escaped(&format!("{}, {}", machine.line(), machine.system)));
    let pairs = if rows().any(|row| row.pair.is_some()) {
        "Compared runs followed each other in pairs."
    } else {
        "Each repetition visits the configurations in a new random order."
    };
    let doubted = results.doubts().count();
    let doubts = match doubted {
        0 => String::new(),
        some => format!("\nThe times of {} are in doubt.", counted(some, "run")),
    };
    format!(
        "We measured {}{often} with Pathmark{version}~\\cite{{pathmark}}, on {machine}.\n{pairs}\nIntervals have 95\\,\\% confidence where they name no other.{doubts}",
        counted(cells, "configuration"),
    )
}

/// A name that may stand in a label.
fn label(words: [&str; 2]) -> String {
    let plain = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '-' };
    words.join("-").chars().map(plain).collect()
}

fn figure(experiment: &str, block: &Block) -> Option<String> {
    let (stem, title) = match block {
        Block::Figure { stem, figure } => (stem, figure.drawing().title),
        Block::Picture { stem, title, .. } => (stem, title.clone()),
        _ => return None,
    };
    let (title, label) = (prose(&title), label([experiment, stem]));
    Some(format!(
        "\\begin{{figure}}\n\\centering\n\\includegraphics[width=\\linewidth]{{\\results/{experiment}/figures/{stem}}}\n\
         \\caption{{{title}}}\n\\label{{fig:{label}}}\n\\end{{figure}}\n"
    ))
}

fn table_of(experiment: &str, stem: &str, table: &Table) -> String {
    let is_shown: Vec<bool> = (0..table.heads().count()).map(|column| !table.is_blank(column)).collect();
    let shown = |cells: Vec<String>| {
        cells.into_iter().zip(&is_shown).filter(|(_, is_shown)| **is_shown).map(|(cell, _)| cell).collect()
    };
    let heads: Vec<String> = shown(table.heads().map(str::to_string).collect());
    let rows: Vec<Vec<String>> = table.rows().take(MOST_ROWS).map(shown).collect();
    let more = match table.len().saturating_sub(MOST_ROWS) {
        0 => String::new(),
        more => format!("% {} more: {experiment}/figures/{stem}.csv\n", counted(more, "row")),
    };
    let (title, label, body) = (prose(&table.title), label([experiment, stem]), tabular(&heads, &rows));
    format!(
        "\\begin{{table}}\n\\centering\\footnotesize\n\\caption{{{title}}}\n\\label{{tab:{label}}}\n{body}{more}\\end{{table}}\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures;
    use crate::latex::tests::assert_balanced;
    use crate::measure::Record;
    use crate::tests::{results, row};

    fn paper(figures: &[&str], rows: Vec<Record>) -> String {
        let mut results = results(figures, "", rows).unwrap();
        results.definition.title = "50 % {of} `a_b` & \\c".to_string();
        results.run.until = None;
        let blocks = figures::blocks(&results).unwrap();
        text(&[Part { results, blocks }], "../out")
    }

    fn speedups() -> Vec<Record> {
        let strategies = [("serial", 1, 2.0), ("pool_one", 2, 1.0), ("pool-two", 2, 1.1)];
        let rows = (0..6).flat_map(|repetition| {
            strategies.map(|(strategy, threads, seconds)| {
                let makespan_s = Some(seconds * (1.0 + 0.01 * f64::from(repetition)));
                Record { repetition, threads, strategy: strategy.to_string(), makespan_s, ..row() }
            })
        });
        rows.collect()
    }

    #[test]
    fn a_paper_has_figures_a_table_with_intervals_and_the_sources_of_its_rules() {
        let paper = paper(&["speedup"], speedups());
        assert_balanced(&paper);
        let parts = [
            "\\title{50 \\% \\{of\\} \\texttt{a\\_b} \\& \\textbackslash{}c}",
            "\\includegraphics[width=\\linewidth]{\\results/an-experiment/figures/speedup}",
            "\\newcommand{\\results}{../out}",
            "We measured 18 configurations in up to 6 repetitions with Pathmark",
            "~\\cite{pathmark}, on 2 processors",
            "\\begin{tabular}",
            "pool\\_one",
            "\\cite{karp1990}",
            "\\bibitem{karp1990} A. H. Karp",
        ];
        for part in parts {
            assert!(paper.contains(part), "{part}: {paper}");
        }
        // Rules that were not applied have no source.
        assert!(!paper.contains("robbins") && !paper.contains("olsson") && !paper.contains("amdahl"), "{paper}");
    }

    /// Squared errors of 1 and 9 have a variation above 0.3, those of 1 and 1.1 have not.
    #[test]
    fn skewed_errors_cite_the_interval_of_a_log_normal_mean() {
        let rows = |second: f64| {
            let seeds = [(1, 0.01), (2, 0.01 * second), (3, 0.0101)];
            seeds.map(|(seed, mse)| Record { seed, mse: Some(mse), ..row() }).to_vec()
        };
        assert!(paper(&["schedules"], rows(9.0)).contains("\\bibitem{olsson2005}"));
        assert!(!paper(&["schedules"], rows(1.1)).contains("olsson2005"));
    }
}
