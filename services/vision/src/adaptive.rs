//! What real cameras need beyond the fixed statistics of thesis 4.0.3.

pub(crate) mod palette;
