//! What was found, and what to do about it.

use serde::Serialize;

/// Whether something is as it should be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Verdict {
    /// It is.
    Yes,
    /// It is not.
    No,
    /// There is nothing to look at, or no way to look.
    NotApplicable,
}

/// The answer to one question.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(super) struct Finding {
    /// What was asked.
    pub(super) check: String,
    /// The answer.
    pub(super) verdict: Verdict,
    /// What was seen.
    pub(super) found: String,
    /// What to do, after a no.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) remedy: Option<String>,
}

impl Finding {
    pub(super) fn yes(check: impl Into<String>, found: impl Into<String>) -> Self {
        Self { check: check.into(), verdict: Verdict::Yes, found: found.into(), remedy: None }
    }

    pub(super) fn no(check: impl Into<String>, found: impl Into<String>, remedy: impl Into<String>) -> Self {
        let remedy = Some(remedy.into());
        Self { check: check.into(), verdict: Verdict::No, found: found.into(), remedy }
    }

    pub(super) fn not_applicable(check: impl Into<String>, why: impl Into<String>) -> Self {
        Self { check: check.into(), verdict: Verdict::NotApplicable, found: why.into(), remedy: None }
    }
}

/// A line for each finding, and one below it for what to do.
pub(super) fn listed(findings: &[Finding]) -> String {
    let width = findings.iter().map(|finding| finding.check.chars().count()).max().unwrap_or(0);
    let mut text = String::new();
    for Finding { check, verdict, found, remedy } in findings {
        let verdict = match verdict {
            Verdict::Yes => "yes",
            Verdict::No => "no",
            Verdict::NotApplicable => "n/a",
        };
        text.push_str(&format!("{verdict:<3}  {check:<width$}  {found}\n"));
        if let Some(remedy) = remedy {
            text.push_str(&format!("{:<3}  {:<width$}  → {remedy}\n", "", ""));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remedies_stand_below_what_was_found() {
        let findings = [
            Finding::yes("router", "reached in 2 ms"),
            Finding::no("ports", "127.0.0.1:8080 is taken", "set http.listen"),
            Finding::not_applicable("camera", "a leader has none"),
        ];
        let expected = "yes  router  reached in 2 ms\nno   ports   127.0.0.1:8080 is taken\n             → set http.listen\n\
                        n/a  camera  a leader has none\n";
        assert_eq!(listed(&findings), expected);
    }
}
