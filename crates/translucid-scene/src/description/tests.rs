//! Laws of every description: keys that are listed are read, and what is written reads back where it is valid.

use std::fmt::Debug;

use super::{Content, Counts, Entry, FileList, Part, Provenance, Table, Thing, Visit};
use crate::{Camera, Environment, Film, Integrator, Light, Material, SceneError};

/// Numbers at and beyond the ends of ranges.
const NUMBERS: [f32; 21] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    -1.0,
    0.0,
    1e-30,
    0.5,
    1.0,
    2.0,
    4.5,
    90.0,
    100.0,
    179.5,
    180.0,
    1024.0,
    16_385.0,
    1e7,
    1e10,
    3e10,
    1e13,
    1e20,
];

fn read<T: Clone>(thing: &Thing<T>, entries: &[Entry]) -> Result<T, SceneError> {
    let source = Provenance::part("it");
    let table = Table::root(&source, entries).allow(&thing.keys())?;
    thing.read(&table, &mut FileList::default())
}

/// A law of a thing, whatever its type.
macro_rules! for_each_thing {
    ($law:ident) => {
        $law(&Camera::DESCRIPTION);
        $law(&Film::DESCRIPTION);
        $law(&Integrator::DESCRIPTION);
        $law(&Environment::DESCRIPTION);
        $law(&Material::DESCRIPTION);
        Light::KINDS.into_iter().for_each($law);
    };
}

#[test]
fn plain_things_are_valid_and_read_back() {
    fn law<T: Clone + Debug + PartialEq>(thing: &Thing<T>) {
        let plain = (thing.plain)();
        assert_eq!(thing.check(&plain, &Counts::default()), Ok(()), "{}", thing.name);
        assert_eq!(read(thing, &thing.write(&plain)), Ok(plain.clone()), "{}", thing.name);
        assert_eq!(thing.write_changes(&plain, &plain), [], "{}", thing.name);
    }
    for_each_thing!(law);
}

#[test]
fn every_key_is_read() {
    fn law<T: Clone>(thing: &Thing<T>) {
        let plain = thing.write(&(thing.plain)());
        // An environment reads its image itself
        for key in thing.keys().into_iter().filter(|key| *key != "file") {
            let mut entries: Vec<Entry> = plain.iter().filter(|entry| entry.key != key).cloned().collect();
            entries.push(Entry::new(key, Content::Other("a date")));
            let error = read(thing, &entries).err().unwrap_or_else(|| panic!("{} ignores {key}", thing.name));
            assert!(error.message.contains(key), "{}: {}", thing.name, error.message);
        }
    }
    for_each_thing!(law);
}

/// Every number in turn is set to every value: what a check refuses is refused when it is read, and the other way round.
#[test]
fn tables_and_things_have_the_same_ranges() {
    fn law<T: Clone>(thing: &Thing<T>) {
        let mut count = 0;
        thing.visit(&mut (thing.plain)(), &mut |_, _| count += 1);
        for (number, value) in (0..count).flat_map(|number| NUMBERS.map(|value| (number, value))) {
            let (mut changed, mut seen, mut place) = ((thing.plain)(), 0, String::new());
            thing.visit(&mut changed, &mut |name, part| {
                if seen == number {
                    name.clone_into(&mut place);
                    match part {
                        Part::Number(slot, _) => *slot = value,
                        Part::Count(slot, _) => *slot = value as u32,
                        Part::Index(..) => {}
                    }
                }
                seen += 1;
            });
            let checked = thing.check(&changed, &Counts::default());
            let read = read(thing, &thing.write(&changed));
            assert_eq!(read.is_ok(), checked.is_ok(), "{} {place} = {value}: {:?}", thing.name, read.err());
        }
    }
    for_each_thing!(law);
}

#[test]
fn every_key_has_a_meaning() {
    fn law<T>(thing: &Thing<T>) {
        assert!(!thing.doc.is_empty());
        for key in thing.fields.iter().flat_map(|field| field.keys) {
            assert!(!key.doc.is_empty(), "{}.{}", thing.name, key.name);
        }
    }
    for_each_thing!(law);
}
