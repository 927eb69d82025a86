// SPDX-License-Identifier: Apache-2.0
// A servo on an Arduino that turns a lens: profile = "sketch" of Fathom's rig driver "serial".
//
// A line "G 512" goes to 512, "S" stops, "?" is answered "at 512 still" or "at 300 moving". Positions are
// 0 to 1000, the servo's whole turn. It moves slowly, so that the lens is not shaken.
#include <Servo.h>

const int kPin = 9;
const long kHighest = 1000;
const long kStepsPerSecond = 250;

Servo servo;
long place = 0, target = 0;
unsigned long last_step_us = 0;
char line[16];
byte length = 0;

void turn() { servo.writeMicroseconds(map(place, 0, kHighest, 1000, 2000)); }

void setup() {
  Serial.begin(115200);
  servo.attach(kPin);
  turn();
  Serial.println("focus motor 1");
}

void answer() {
  if (line[0] == '?') {
    Serial.print("at ");
    Serial.print(place);
    Serial.println(place == target ? " still" : " moving");
  } else if (line[0] == 'S') {
    target = place;
    Serial.println("ok");
  } else if (line[0] == 'G' && atol(line + 1) >= 0 && atol(line + 1) <= kHighest) {
    target = atol(line + 1);
    Serial.println("ok");
  } else {
    Serial.println("no: G 0 to G 1000, S, ?");
  }
}

void loop() {
  while (Serial.available() > 0) {
    const char c = Serial.read();
    if (c == '\n') {
      line[length] = 0;
      if (length > 0) answer();
      length = 0;
    } else if (c != '\r' && length < sizeof line - 1) {
      line[length++] = c;
    }
  }
  if (place != target && micros() - last_step_us >= 1000000UL / kStepsPerSecond) {
    last_step_us = micros();
    place += place < target ? 1 : -1;
    turn();
  }
}
