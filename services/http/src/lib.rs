//! The web face that leader and follower share: a hardened accept loop, problem details, picture and event streams, the embedded page.
