//! Registration of the leader's landmarks in live cameras: subscriptions, journal, web face.
