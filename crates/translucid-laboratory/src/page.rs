//! A page of text, charts and tables.

use crate::chart::Chart;
use crate::data_table::DataTable;

/// A piece of a section.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    /// A paragraph, without markup.
    Text(String),
    /// A chart with its caption.
    Chart(Chart),
    /// A table with its caption.
    Table(DataTable),
}

/// A part of a page under one title.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Its title.
    pub title: String,
    /// What it consists of, from top to bottom.
    pub blocks: Vec<Block>,
}

/// A page of text, charts and tables.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    /// Its title.
    pub title: String,
    /// Paragraphs before the table of contents, without markup.
    pub introduction: Vec<String>,
    /// Its sections.
    pub sections: Vec<Section>,
}

impl Section {
    /// A section without blocks.
    pub fn new(title: &str) -> Self {
        Self { title: title.to_owned(), blocks: Vec::new() }
    }
}

impl Page {
    /// The charts, from top to bottom.
    pub fn charts(&self) -> impl Iterator<Item = &Chart> {
        self.blocks().filter_map(|block| if let Block::Chart(chart) = block { Some(chart) } else { None })
    }

    /// The tables, from top to bottom.
    pub fn tables(&self) -> impl Iterator<Item = &DataTable> {
        self.blocks().filter_map(|block| if let Block::Table(table) = block { Some(table) } else { None })
    }

    fn blocks(&self) -> impl Iterator<Item = &Block> {
        self.sections.iter().flat_map(|section| &section.blocks)
    }
}
