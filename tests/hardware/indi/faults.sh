# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash disable=SC2154  # run and server.sh set the rest
# The server and its drivers killed while they expose and while they move: each must end the
# measurement with an error in time, and the rig can be opened again. To be sourced by run.

failures=0

complain() {
  echo "FAILED: $*" >&2
  failures=$((failures + 1))
}

state_of() { indi_getprop -t 1 -1 "$1._STATE" 2>/dev/null; }

driver_pid() { pgrep -P "$server_pid" -f "$1"; }

# begin FATHOM OPTIONS...: a measurement in the background, as $measurement.
# Under job control: else the shell would start it deaf to Ctrl-C, and what it finds ignored it leaves
# so.
begin() {
  set -m
  "$1" focus --rig "$folder/rig.toml" "${@:2}" >"$folder/out" 2>&1 &
  measurement=$!
  set +m
}

# until_exposing: waits for the camera to be busy.
until_exposing() {
  local tries=0
  until [ "$(state_of "$camera.CCD_EXPOSURE")" = Busy ]; do
    [ $((tries += 1)) -lt 50 ] || { complain "no exposure began"; return; }
    sleep 0.1
  done
}

# expect_end WHAT STATUS TEXT: the measurement ends within five seconds, and says so.
expect_end() {
  local waited=0 status
  while kill -0 "$measurement" 2>/dev/null && [ "$waited" -lt 50 ]; do
    sleep 0.1
    waited=$((waited + 1))
  done
  if [ "$waited" -ge 50 ]; then
    complain "$1: no end within 5 s"
    kill -9 "$measurement"
  fi
  wait "$measurement"
  status=$?
  echo "$1: ended after $((waited / 10)).$((waited % 10)) s with $status: $(grep -m 1 '^fathom:' "$folder/out")"
  [ "$status" -eq "$2" ] || complain "$1: exit status $status, not $2"
  grep -q "$3" "$folder/out" || { complain "$1: no \"$3\" in:"; cat "$folder/out" >&2; }
}

# expect_works FATHOM: the rig can be opened and used.
expect_works() {
  "$1" focus --rig "$folder/rig.toml" --from 30000 --to 45000 >"$folder/out" 2>&1 || {
    complain "the rig does not work again:"
    cat "$folder/out" >&2
  }
}

restart() {
  stop_simulators -KILL
  start_simulators "$folder" || complain "the simulators do not start again"
}

faults() {
  local fathom=$1
  sed -i 's/^exposure_ms = .*/exposure_ms = 10000/' "$folder/rig.toml"
  begin "$fathom"
  until_exposing
  kill -9 "$server_pid"
  expect_end 'server killed in mid-exposure' 1 'closed the connection\|is gone'

  restart
  begin "$fathom"
  until_exposing
  kill -9 "$(driver_pid indi_simulator_ccd)"
  expect_end 'camera driver killed in mid-exposure' 1 'crashed\|closed the connection'

  restart
  begin "$fathom"
  until_exposing
  kill -INT "$measurement"
  expect_end 'Ctrl-C in mid-exposure' 1 'stopped on request'
  [ "$(state_of "$camera.CCD_EXPOSURE")" != Busy ] || complain 'the exposure goes on after Ctrl-C'
  [ "$(indi_getprop -1 "$camera.CCD_FRAME.WIDTH")" = 1280 ] || complain 'the frame was not put back'
  [ "$(indi_getprop -1 "$camera.POLLING_PERIOD.PERIOD_MS")" = 1000 ] ||
    complain 'the polling period was not put back'

  sed -i "s/^exposure_ms = .*/exposure_ms = 100/" "$folder/rig.toml"
  expect_works "$fathom"

  # A slow motor: half a minute to the first position, in which the driver says nothing.
  indi_setprop "$focuser.DELAY.DELAY_VALUE=2000"
  begin "$fathom"
  sleep 3
  kill -9 "$(driver_pid indi_simulator_focus)"
  expect_end 'focuser driver killed in mid-move' 1 'crashed\|closed the connection'

  SCENE_DELAY=2000 restart
  begin "$fathom"
  sleep 3
  kill -9 "$server_pid"
  expect_end 'server killed in mid-move' 1 'closed the connection\|is gone'

  restart
  expect_works "$fathom"
  [ "$failures" -eq 0 ]
}
