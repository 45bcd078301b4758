"""The commands of ``runningbond``; `runningbond.commands.command_line` combines them."""
