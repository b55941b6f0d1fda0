# For the scripts beside this file, which read it with `.`: $without_network before a command hides all networks from it.
without_network="unshare --net"
if ! $without_network true 2>/dev/null; then
    without_network="unshare --map-root-user --net"
    $without_network true 2>/dev/null || {
        echo "without_network: this user may hide no network; the next commands could use it" >&2
        without_network=
    }
fi
