//! Which experiments are asked for.

use super::{ALL, Experiment, Place};

/// Something was asked for that is no experiment.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no experiment is called `{given}`; there are {}", known.join(", "))]
pub struct UnknownSelection {
    given: String,
    known: Vec<&'static str>,
}

/// The experiments that `wanted` names: by the number of a figure or table (`4.1`), by a section and all below it
/// (`4.0.6`, `3.2`), or by a chapter (`2`). All where nothing is named.
///
/// # Errors
/// When a name stands for none.
pub fn selected(wanted: &[String]) -> Result<Vec<Experiment>, UnknownSelection> {
    for given in wanted {
        if !ALL.iter().any(|experiment| is_named(experiment, given)) {
            let known = ALL.iter().map(|experiment| experiment.number).collect();
            return Err(UnknownSelection { given: given.clone(), known });
        }
    }
    let is_wanted = |experiment: &&Experiment| {
        wanted.is_empty() || wanted.iter().any(|given| is_named(experiment, given))
    };
    Ok(ALL.iter().filter(is_wanted).copied().collect())
}

/// Figures that are shown with another one: theirs, and that one's.
const SHOWN_WITH: [(&str, &str); 5] =
    [("2.3", "2.4"), ("3.1", "3.2"), ("3.4", "3.5"), ("4.2", "4.3"), ("4.11", "4.12")];

fn is_named(experiment: &Experiment, given: &str) -> bool {
    let is_shown_here = SHOWN_WITH.iter().any(|(figure, with)| {
        *figure == given && experiment.place == Place::Figure && experiment.number == *with
    });
    let within =
        |whole: &str| whole == given || whole.strip_prefix(given).is_some_and(|rest| rest.starts_with('.'));
    is_shown_here || experiment.number.eq_ignore_ascii_case(given) || within(experiment.section)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(wanted: &[&str]) -> Vec<&'static str> {
        let wanted: Vec<String> = wanted.iter().map(|&given| given.to_owned()).collect();
        selected(&wanted).unwrap().iter().map(|experiment| experiment.number).collect()
    }

    #[test]
    fn numbers_sections_and_chapters_name_experiments() {
        assert_eq!(numbers(&[]).len(), ALL.len());
        assert!(numbers(&["4.0.6"]).contains(&"4.8"));
        assert!(numbers(&["3.4"]).contains(&"3.5") && numbers(&["4.11"]) == ["4.12"]);
        assert!(numbers(&["d.1"]).contains(&"D.1"));
        let of_chapters: usize = ["2", "3", "4"]
            .iter()
            .filter(|chapter| selected(&[(**chapter).to_owned()]).is_ok())
            .map(|chapter| numbers(&[chapter]).len())
            .sum();
        assert_eq!(of_chapters, ALL.len());
        assert!(numbers(&["4.1"]).iter().all(|number| *number == "4.1"), "4.1 is not 4.10");
    }

    #[test]
    fn what_is_unknown_is_told_with_the_known_ones() {
        let error = selected(&["9.9".to_owned()]).unwrap_err().to_string();
        assert!(error.contains("`9.9`") && error.contains("4.8"), "{error}");
    }
}
