//! `mpiexec -n 2 pathmark inspect messages`: the costs of MPI messages on this machine.

use crate::cluster::{Cluster, MessageCost, MessageCosts};
use crate::verbs::prelude::*;

/// `mpiexec -n 2 pathmark inspect messages`
#[derive(Args)]
pub(crate) struct Arguments {
    /// MPI library: auto, or the path of one [default: auto, or `PATHMARK_MPI`]
    #[arg(long, value_name = "auto|FILE")]
    mpi: Option<PathBuf>,
    /// Print the costs as one JSON object
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<()> {
    let cluster = Cluster::begin(arguments.mpi.as_deref())?;
    let Some(told) = cluster.message_costs()? else { return Ok(()) };
    if arguments.json {
        return print_json(&told);
    }
    let MessageCosts { ranks, mpi, costs } = told;
    print(&format!("{ranks} ranks of {mpi}; microseconds, medians with 95 % intervals"))?;
    print(&format!("{:>10} {:>22} {:>11}  operation, while rank 0", "median", "interval", "repetitions"))?;
    for MessageCost { operation, rank_0, repetitions, median_s, low_s, high_s } in costs {
        let [median, low, high] = [median_s, low_s, high_s].map(|seconds| 1e6 * seconds);
        let interval = format!("{low:.2} to {high:.2}");
        print(&format!("{median:>10.2} {interval:>22} {repetitions:>11}  {operation}, {rank_0}"))?;
    }
    Ok(())
}
