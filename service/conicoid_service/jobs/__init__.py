"""Jobs: batches of cameras over one scene, kept on the disk until they are done and some time after.

`jobs` is what the application sees. Below it, `store`, `work` and `upkeep` are what requests, workers and upkeep do to
the tables in `database`, `image_shelf` and `folder` the files beside them, all in the one thread of `disk`; `runner`
has `painter` render frames, `keeper` takes up what was left and gives up what is over, `events` tells of progress.
"""
