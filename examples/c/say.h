/* The example's only need besides the library. */
#pragma once

/* Prints text where the machine has a place for it. */
void say(const char *text);
