import sys

from . import arguments, command

sys.exit(command.main(arguments.parse(sys.argv[1:])))
