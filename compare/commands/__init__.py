"""The commands of ``runningbond``, one a module; `compare.command` is where they meet."""
