//! `waymark doctor`.

mod cameras;
mod disk;
mod echo;
mod finding;
mod fleet;
mod landmarks;
mod network;
mod ports;
mod subject;

use std::time::Duration;

use serde_json::{Value, json};

use crate::commands::config::Service;
use crate::commands::service::ConfigArgs;
use crate::console::Console;
use crate::exit::{Ending, Failure};
use finding::{Finding, Verdict, listed};
use subject::Subject;

/// Say what keeps a vehicle from working, and what to do about it
///
/// Looks, with the configuration of one of its services, whether the router is reachable, what is published comes back
/// through it, clocks and versions of all members agree, landmarks and pictures arrive, the disk is fast and empty
/// enough to record, and the ports are free. Changes nothing, and may be asked while the service runs. Exit code 0
/// when every answer is yes, 1 when one is no.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The service that is to run here
    #[arg(default_value = "follower")]
    service: Service,

    #[command(flatten)]
    config: ConfigArgs,

    /// Print the answers as JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args, console: Console) -> Result<Ending, Failure> {
    let subject = Subject::read(args.service, &args.config)?;
    console.note(&format!("examining {} of vehicle {}", subject.role(), subject.keys.vehicle()));
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build()?;
    let findings = runtime.block_on(examine(&subject));
    // A disk that hangs must not keep the program.
    runtime.shutdown_timeout(Duration::ZERO);
    let text = if args.json { format!("{:#}\n", as_json(&subject, &findings)) } else { listed(&findings) };
    Console::write_results(text.as_bytes())?;
    Ok(if is_fine(&findings) { Ending::Fine } else { Ending::Damaged })
}

/// Every part keeps a deadline of its own, so that all together end.
async fn examine(subject: &Subject) -> Vec<Finding> {
    let (network, ports, disk) =
        tokio::join!(network::examine(subject), ports::examine(subject), disk::examine(subject));
    [network, ports, disk].concat()
}

fn is_fine(findings: &[Finding]) -> bool {
    findings.iter().all(|finding| finding.verdict != Verdict::No)
}

fn as_json(subject: &Subject, findings: &[Finding]) -> Value {
    json!({
        "vehicle": subject.keys.vehicle().as_str(),
        "service": subject.role(),
        "version": env!("CARGO_PKG_VERSION"),
        "fine": is_fine(findings),
        "checks": findings,
    })
}
