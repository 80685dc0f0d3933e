#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""python_types_test.py README INSTALL: every type of a message or service in README has its Python module, which `rostopic echo` and
`rosservice call` need, from a package that the script INSTALL names."""
import importlib
import importlib.util
import re
import sys

readme, install = (open(path, encoding='utf-8').read() for path in sys.argv[1:])
types = set(re.findall(r'\b([a-z][a-z0-9_]*_msgs|std_srvs|dynamic_reconfigure)/([A-Z]\w*)', readme)) | {('tf2_msgs', 'TFMessage'), ('rosgraph_msgs', 'Clock'),
                                                                                                        ('diagnostic_msgs', 'DiagnosticArray')}
assert len(types) > 9, types
faults = []
for package, name in sorted(types):
    try:
        names = [package + '.' + kind for kind in ('msg', 'srv')]
        kinds = [importlib.import_module(kind) for kind in names if importlib.util.find_spec(kind)]
        if not any(hasattr(kind, name) for kind in kinds):
            faults.append('%s/%s is not in the Python module %s' % (package, name, package))
    except ImportError as error:
        faults.append('%s/%s: %s' % (package, name, error))
    if 'python3-' + package.replace('_', '-') not in install:
        faults.append('python3-%s is not installed by the script' % package.replace('_', '-'))
print('\n'.join(faults))
sys.exit(bool(faults))
