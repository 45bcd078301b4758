"""The commands of ``runningbond``, one a module; `runningbond.commands.command_line` is where they meet."""
