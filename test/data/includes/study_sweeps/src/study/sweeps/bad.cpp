#include "study/workspace/workspace_run.h"
