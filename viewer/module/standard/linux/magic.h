// <linux/magic.h>, of which emscripten has nothing: the number by which statfs names pipes.
#pragma once

#define PIPEFS_MAGIC 0x50495045
