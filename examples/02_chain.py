"""Run the whole chain: from an instruction to a data set and a report.

    python examples/02_chain.py [RUN]

RUN (default: runs/blocks) is the run folder. Started again, the program goes on where it stopped, and does nothing
where all is finished. A small collection like this one takes about a minute on two cores. No `if __name__ ==
"__main__"` is needed: worker processes do not run this script again.
"""

import sys

import vcage

run = vcage.RunFolder(sys.argv[1] if len(sys.argv) > 1 else "runs/blocks")
options = vcage.ChainOptions(
    instruction="Put two blocks on the plate",
    models="offline",  # rules answer; "auto" takes a provider whose key is there
    episodes=1,
    fps=5,
    compression=vcage.CompressionSettings(crf=20, effort="fast", keyframes=2),  # no search: quick, not small
)
done = vcage.run_chain(run, options)
for stage, result in done.items():
    print(f"{stage}: {'made now' if result.fresh else 'finished before'}")

for episode in done["collect"].record.episodes:
    with vcage.EpisodeReader(run.root / episode.file) as reader:
        task, pictures = reader.episode.meta["task"], reader.images("cam_high")
        print(f"{task} {len(reader.episode.action)} steps, pictures {pictures.shape}")
print(f"report: {vcage.write_report(run)}")
