//! Where a key stands in a TOML text.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Line (from 1) and text of the line that holds the key, or the innermost table on the way to it that exists.
pub(super) fn line_of_key<'text>(text: &'text str, path: &[String]) -> Option<(usize, &'text str)> {
    let table = DeTable::parse(text).ok()?;
    let offset = offset_of_key(table.get_ref(), path)?;
    let before = text.get(..offset)?;
    let line = before.matches('\n').count();
    Some((line + 1, text.lines().nth(line)?.trim_end()))
}

fn offset_of_key(table: &DeTable<'_>, path: &[String]) -> Option<usize> {
    let (first, rest) = path.split_first()?;
    let (key, value): (&Spanned<_>, &Spanned<DeValue<'_>>) =
        table.iter().find(|(key, _)| key.get_ref().as_ref() == first)?;
    let deeper = value.get_ref().as_table().and_then(|table| offset_of_key(table, rest));
    deeper.or(Some(key.span().start))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "vehicle = \"v1\"\n\n[http]\nlisten = \"x\"\n\n[http.limits]\nclients = -1 # few\n";

    fn located(path: &str) -> Option<(usize, &'static str)> {
        line_of_key(TEXT, &path.split('.').map(str::to_owned).collect::<Vec<_>>())
    }

    #[test]
    fn keys_are_found_at_every_depth() {
        assert_eq!(located("vehicle"), Some((1, "vehicle = \"v1\"")));
        assert_eq!(located("http.listen"), Some((4, "listen = \"x\"")));
        assert_eq!(located("http.limits.clients"), Some((7, "clients = -1 # few")));
    }

    #[test]
    fn a_missing_key_is_placed_at_its_table() {
        assert_eq!(located("http.limits.bytes"), Some((6, "[http.limits]")));
        assert_eq!(located("nothing"), None);
    }
}
