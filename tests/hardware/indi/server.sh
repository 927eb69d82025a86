# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# INDI's own simulators of a camera and a focuser, on the real indiserver. To be sourced, in a
# network namespace of its own: indiserver listens on every address.
#
# The scene, by environment (and gsc has the stars):
#   SCENE_BEST      position of best focus, steps (36700)
#   SCENE_SEEING    blur that is always there, arc seconds (3.5)
#   SCENE_NOISE     of the camera, grey levels (10)
#   SCENE_DELAY     of the motor for each step, us (0)

camera="CCD Simulator"
focuser="Focuser Simulator"
server_pid=""

# start_simulators FOLDER: starts and connects both; their log and settings go to the folder.
start_simulators() {
  local folder=$1 here
  here=$(dirname "${BASH_SOURCE[0]}")
  HOME=$folder PATH="$here:$PATH" \
    indiserver -r 0 indi_simulator_ccd indi_simulator_focus >"$folder/indiserver.log" 2>&1 &
  server_pid=$!
  disown "$server_pid"  # or the shell remarks on every kill
  await_property "$camera.CONNECTION.CONNECT"
  await_property "$focuser.CONNECTION.CONNECT"
  indi_setprop "$camera.CONNECTION.CONNECT=On" "$focuser.CONNECTION.CONNECT=On"
  await_property "$camera.SCOPE_INFO.FOCAL_LENGTH"
  await_property "$focuser.ABS_FOCUS_POSITION.FOCUS_ABSOLUTE_POSITION"
  # The blur follows from the focal length: without one there are no stars at all.
  indi_setprop "$camera.SCOPE_INFO.FOCAL_LENGTH;APERTURE=900;120"
  indi_setprop "$focuser.DELAY.DELAY_VALUE=${SCENE_DELAY:-0}"
  indi_setprop "$camera.SIM_FOCUSING.SIM_FOCUS_POSITION;SIM_SEEING=${SCENE_BEST:-36700};${SCENE_SEEING:-3.5}"
  indi_setprop "$camera.SIMULATOR_SETTINGS.SIM_NOISE=${SCENE_NOISE:-10}"
}

await_property() {
  local tries=0
  until indi_getprop -t 1 "$1" >/dev/null 2>&1; do
    [ $((tries += 1)) -lt 20 ] || { echo "indi: no property $1" >&2; return 1; }
    sleep 0.1
  done
}

# stop_simulators [SIGNAL]
stop_simulators() {
  [ -n "$server_pid" ] || return 0
  kill "${1:--TERM}" "$server_pid" 2>/dev/null
  while kill -0 "$server_pid" 2>/dev/null; do sleep 0.05; done
  server_pid=""
}
