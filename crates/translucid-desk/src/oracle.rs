//! *oracle*: tables of light under surfaces, for tests of other programs.

use std::sync::LazyLock;

use translucid_laboratory::comparison::{Stopped, Watch};
use translucid_laboratory::oracle::{
    ORACLE_PHOTONS, SCHEMA_FILE, oracle_names, oracle_schema, oracle_tables,
};
use translucid_words::{Context, Fallback, Rule, Thing, WholeInterval, field, whole, words};

use crate::answer::{About, Answer, Control, Form, NamedFile, Question, Unanswered};

use Fallback::{Plain, Words};

/// Which tables, and how well.
#[derive(Clone, Debug)]
pub struct AskedOracle {
    only: Vec<&'static str>,
    photons: u64,
}

/// Photons that know their error.
const FEWEST_PHOTONS: u64 = 1000;

static NAMES: LazyLock<Vec<(&str, &str)>> =
    LazyLock::new(|| oracle_names().into_iter().map(|name| (name, name)).collect());

/// *oracle*.
#[rustfmt::skip]
pub static ORACLE: Question<AskedOracle> = Question {
    thing: Thing {
        name: "oracle",
        doc: "Writes tables of exact light, with errors, that other programs can be tested with",
        plain: || AskedOracle { only: Vec::new(), photons: ORACLE_PHOTONS },
        fields: &[
            field!(AskedOracle { only } => words(only, &NAMES), "Tables to write", Words("all")),
            field!(AskedOracle { photons } => whole(photons, WholeInterval::new(0, u64::MAX)),
                "Number of photons of each walk, at least 1000, and of each sphere a tenth", Plain),
        ],
        rules: &[Rule::Holds {
            key: "photons",
            broken: |asked| (asked.photons < FEWEST_PHOTONS).then(|| {
                format!("at least {FEWEST_PHOTONS}: errors of fewer photons would themselves be unknown")
            }),
            help: "",
        }],
    },
    about: About {
        more: "Each table is NAME.csv and, with units, meanings, method and command, NAME.json, after schema.json:\n  profile: R(r) and the light within r, of half spaces by surface albedo, g, eta and configuration;\n  edge: light beside the edge of a half plane that is lit: what a screen-space pass should show;\n  disk: light in and around a small disk that is lit;\n  line: light in and beside a thin line that is lit;\n  totals: surface albedo by single-scattering albedo;\n  inversion: single-scattering albedo by surface albedo, and the diffuse mean free path;\n  slabs: light that slabs reflect, pass and absorb;\n  spheres: light that leaves spheres.\nLengths are mean free paths. Every number has its error. The files have the same bytes each time.\ndocs/guide/oracle.md shows how to test with them.",
        source: "",
        is_by_element: false,
        right: || vec![Vec::new()],
        examples: &["-o oracle", "-o edges --only edge,line"],
        columns: &[],
        formats: &[],
    },
    form: AskedOracle::form,
    answer,
};

impl AskedOracle {
    fn names(&self) -> Vec<&'static str> {
        let is_wanted = |name: &&str| self.only.is_empty() || self.only.contains(name);
        oracle_names().into_iter().filter(is_wanted).collect()
    }

    fn form(&self) -> Form {
        let of_table = |name: &str| [format!("{name}.csv"), format!("{name}.json")];
        let tables = self.names().into_iter().flat_map(of_table);
        Form::Files(std::iter::once(SCHEMA_FILE.into()).chain(tables).collect())
    }
}

fn answer(asked: &AskedOracle, _: &Context, control: &Control<'_>) -> Result<Answer, Unanswered> {
    let watch = Watch { stop: control.stop, progress: control.progress };
    let tables =
        oracle_tables(&asked.names(), asked.photons, watch).map_err(|Stopped| Unanswered::Stopped)?;
    let contents = tables.into_iter().flat_map(|table| [table.data.csv(), table.json]);
    let contents = std::iter::once(oracle_schema()).chain(contents);
    let Form::Files(names) = asked.form() else { return Ok(Answer::default()) };
    let file = |(name, text): (String, String)| NamedFile { name, bytes: text.into_bytes() };
    Ok(Answer { files: names.into_iter().zip(contents).map(file).collect(), ..Answer::default() })
}
