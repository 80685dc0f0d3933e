#!/bin/bash
# without_localhost.sh COMMAND...: runs it where /etc/hosts is empty; ends with status 77 where that cannot be arranged.
unshare -r -m mount --bind /dev/null /etc/hosts 2>/dev/null || exit 77
exec unshare -r -m bash -c 'mount --bind /dev/null /etc/hosts && exec "$@"' bash "$@"
