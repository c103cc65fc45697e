//! Query parameters, strictly: each is named once, known, and within its limits, or the answer is 400.

use crate::problem::Problem;
use std::collections::BTreeMap;
use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// The parameters of one request; take each known one, then call [`Parameters::finish`].
#[derive(Debug)]
pub struct Parameters {
    values: BTreeMap<String, String>,
    known: Vec<&'static str>,
}

impl Parameters {
    /// Reads the part of the address behind `?`.
    ///
    /// # Errors
    /// 400 when a parameter is given twice.
    pub fn parse(query: Option<&str>) -> Result<Self, Problem> {
        let mut values = BTreeMap::new();
        for (name, value) in form_urlencoded::parse(query.unwrap_or_default().as_bytes()) {
            if values.contains_key(name.as_ref()) {
                return Err(Problem::parameter(&name, &value, "one value for each parameter"));
            }
            values.insert(name.into_owned(), value.into_owned());
        }
        Ok(Self { values, known: Vec::new() })
    }

    /// Takes a parameter as it stands.
    pub fn text(&mut self, name: &'static str) -> Option<String> {
        self.known.push(name);
        self.values.remove(name)
    }

    /// Takes a number within limits.
    ///
    /// # Errors
    /// 400 when it does not parse or lies outside.
    pub fn number<N>(&mut self, name: &'static str, allowed: RangeInclusive<N>) -> Result<Option<N>, Problem>
    where
        N: FromStr + PartialOrd + Display,
    {
        let Some(text) = self.text(name) else { return Ok(None) };
        match text.parse::<N>() {
            Ok(number) if allowed.contains(&number) => Ok(Some(number)),
            _ => {
                let limits = format!("a number from {} to {}", allowed.start(), allowed.end());
                Err(Problem::parameter(name, &text, &limits))
            }
        }
    }

    /// Takes a comma-separated choice out of `allowed`, in the order of `allowed`; an empty value chooses none.
    ///
    /// # Errors
    /// 400 when one of the names is not allowed.
    pub fn choice(
        &mut self,
        name: &'static str,
        allowed: &[&'static str],
    ) -> Result<Option<Vec<&'static str>>, Problem> {
        let Some(text) = self.text(name) else { return Ok(None) };
        let asked: Vec<&str> = text.split(',').map(str::trim).filter(|part| !part.is_empty()).collect();
        if let Some(unknown) = asked.iter().find(|part| !allowed.contains(part)) {
            let list = format!("a comma-separated list of {}", allowed.join(", "));
            return Err(Problem::parameter(name, unknown, &list));
        }
        Ok(Some(allowed.iter().copied().filter(|part| asked.contains(part)).collect()))
    }

    /// Refuses what nobody took.
    ///
    /// # Errors
    /// 400 naming the first unknown parameter and the known ones.
    pub fn finish(self) -> Result<(), Problem> {
        let Some((name, value)) = self.values.into_iter().next() else { return Ok(()) };
        let allowed = if self.known.is_empty() {
            "no parameter at this address".to_owned()
        } else {
            format!("only the parameters {}", self.known.join(", "))
        };
        Err(Problem::parameter(&name, &value, &allowed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn takes_what_is_allowed() {
        let mut query = Parameters::parse(Some("width=640&layers=gate,outline&after=7")).unwrap();
        assert_eq!(query.number("width", 16..=3840_u32).unwrap(), Some(640));
        assert_eq!(query.choice("layers", &["outline", "gate"]).unwrap(), Some(vec!["outline", "gate"]));
        assert_eq!(query.number("after", 0..=u64::MAX).unwrap(), Some(7));
        assert_eq!(query.text("absent"), None);
        query.finish().unwrap();
    }

    #[test]
    fn refuses_with_name_value_and_limits() {
        let cases = [("width=1e9", "1e9"), ("width=15", "15"), ("width=-1", "-1"), ("width=", "")];
        for (query, value) in cases {
            let problem =
                Parameters::parse(Some(query)).unwrap().number("width", 16..=3840_u32).unwrap_err().to_json();
            assert_eq!(problem["parameter"], "width");
            assert_eq!(problem["value"], value);
            assert_eq!(problem["allowed"], "a number from 16 to 3840");
        }
    }

    #[test]
    fn refuses_unknown_doubled_and_unlisted() {
        let mut query = Parameters::parse(Some("layer=gate")).unwrap();
        query.choice("layers", &["gate"]).unwrap();
        let problem = query.finish().unwrap_err().to_json();
        assert_eq!(
            (problem["parameter"].as_str(), problem["allowed"].as_str()),
            (Some("layer"), Some("only the parameters layers"))
        );
        assert!(Parameters::parse(Some("a=1&a=2")).is_err());
        assert!(Parameters::parse(Some("layers=mask,x")).unwrap().choice("layers", &["mask"]).is_err());
    }
}
