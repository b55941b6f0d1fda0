#!/bin/sh
# Runs a program for Windows on a machine without a screen: wine.sh PROGRAM [ARGUMENT...]
export WINEDEBUG=-all WINEDLLOVERRIDES='mscoree,mshtml='
PATH=$PATH:/usr/lib/wine exec wine64 "$@"
