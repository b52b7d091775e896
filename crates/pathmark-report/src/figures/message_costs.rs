//! Costs of messages between two processes here, and the time for which a fetch-and-op waits for rank 0.

use crate::cluster::{MessageCost, MessageCosts};
use crate::experiment::MESSAGES;
use crate::prelude::*;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let path = results.folder.join(MESSAGES);
    if !path.is_file() {
        return Ok(vec![Block::notice(format!("There is no {MESSAGES}, so nobody knows what messages cost."))]);
    }
    let told = MessageCosts::read(&path)?;
    let (waiting_s, rendering_s) = (told.fetch_s(), told.fetch_while_rendering_s());
    let finding = format!(
        "{}: a fetch-and-op takes {:.3} us while rank 0 waits, and {:.3} us while it computes and looks after MPI every millisecond.",
        told.mpi,
        1e6 * waiting_s,
        1e6 * rendering_s,
    );
    let median = |cost: &MessageCost| {
        let interval = Interval { low: 1e6 * cost.low_s, high: 1e6 * cost.high_s, level: LEVEL };
        Estimated::of(1e6 * cost.median_s, Some(interval))
    };
    let table = Block::table("message-costs", "What messages cost", &told.costs)
        .column("operation", |cost| cost.operation.clone())
        .column("rank 0 meanwhile", |cost| cost.rank_0.clone())
        .estimated("median, us", Significant(3), |cost| median(cost))
        .column("repetitions", |cost| cost.repetitions.to_string())
        .end();
    Ok(vec![Block::Finding(finding), table])
}
