"""The commands of ``runningbond``; `runningbond.commands.command_line` is where they meet."""
