// MMX, which Eigen includes with SSE2 and does not use. Emscripten has the other SSE headers only.
#pragma once
