# SPDX-License-Identifier: BSD-3-Clause
"""The page and the type stub list what the module has, with its signatures, and everything has a docstring."""
import ast
import inspect
import os
import re
import unittest

import soft_robot_lab
from scenes import SOURCE

PACKAGE = os.path.join(SOURCE, 'src', 'python')


def signature_text(parameters):
    return '(%s)' % ', '.join(parameters)


def signature_of(function):
    """Without the object itself, which inspect leaves out where the function is compiled."""
    signature = inspect.signature(function)
    return str(signature.replace(parameters=[one for name, one in signature.parameters.items() if name != 'self']))


def is_ours(kind, name):
    """Environments have members of Gymnasium's too, where that is installed."""
    return any(name in vars(base) and base.__module__.startswith('soft_robot_lab') for base in kind.__mro__)


def members_of(kind):
    """By name: the signature, or an empty text for what is not called. What Python may make is listed by its class's name."""
    members = {}
    if signature_of(kind.__init__) != '(*args, **kwargs)':
        members[kind.__name__] = signature_of(kind.__init__)
    for name, member in inspect.getmembers(kind):
        if not name.startswith('_') and is_ours(kind, name):
            members[name] = signature_of(member) if callable(member) else ''
    return members


def module_members():
    """By class, '' for functions."""
    found = {'': {}}
    for name in soft_robot_lab.__all__:
        one = getattr(soft_robot_lab, name)
        if inspect.isclass(one):
            if not issubclass(one, Exception):
                found[name] = members_of(one)
        else:
            found[''][name] = signature_of(one)
    return found


def page_members(text):
    found = {'': {}}
    for section in re.split(r'^## ', text, flags=re.MULTILINE)[1:]:
        title, body = section.split('\n', 1)
        rows = re.findall(r'^\| (`[^|]*) \|', body, flags=re.MULTILINE)
        if not rows:
            continue
        members = found.setdefault('' if title == 'Functions' else title, {})
        for row in rows:
            for item in re.findall(r'`\.?(\w+)(\(.*?\))?`', row):
                members[item[0]] = item[1]
    return found


def stub_signature(function, bound):
    arguments = function.args
    given = [argument.arg for argument in arguments.posonlyargs + arguments.args][1 if bound else 0:]
    defaults = [ast.unparse(default) for default in arguments.defaults]
    first = len(given) - len(defaults)
    words = given[:first] + ['%s=%s' % pair for pair in zip(given[first:], defaults)]
    if arguments.vararg or arguments.kwonlyargs:
        words.append('*' + (arguments.vararg.arg if arguments.vararg else ''))
    for argument, default in zip(arguments.kwonlyargs, arguments.kw_defaults):
        words.append(argument.arg if default is None else '%s=%s' % (argument.arg, ast.unparse(default)))
    return signature_text(words + (['**' + arguments.kwarg.arg] if arguments.kwarg else []))


def stub_class(kind):
    members = {}
    for node in kind.body:
        if isinstance(node, ast.AnnAssign):
            members[node.target.id] = ''
        elif isinstance(node, ast.FunctionDef):
            name = kind.name if node.name == '__init__' else node.name
            decorators = [ast.unparse(decorator) for decorator in node.decorator_list]
            static = decorators == ['staticmethod']
            members[name] = '' if decorators and not static else stub_signature(node, not static)
    return members


def with_inherited(kinds):
    """Members of bases that the stub has under a name of their own, which no page lists."""
    for node, members in kinds.values():
        for base in node.bases:
            members.update({name: one for name, one in kinds[base.id][1].items() if name not in members})
    return {name: members for name, (_, members) in kinds.items() if not name.startswith('_')}


def stub_members(text):
    functions, kinds = {}, {}
    for node in ast.parse(text).body:
        if isinstance(node, ast.ClassDef) and not any(base.id.endswith('Error') for base in node.bases):
            kinds[node.name] = node, stub_class(node)
        elif isinstance(node, ast.FunctionDef):
            functions[node.name] = stub_signature(node, False)
    return dict(with_inherited(kinds), **{'': functions})


def text_of(*names):
    with open(os.path.join(PACKAGE, *names), encoding='utf-8') as file:
        return file.read()


class Page(unittest.TestCase):
    maxDiff = None

    def test_page_lists_what_there_is(self):
        self.assertEqual(page_members(text_of('README.md')), module_members())

    def test_stub_lists_what_there_is(self):
        self.assertEqual(stub_members(text_of('soft_robot_lab', '__init__.pyi')), module_members())

    def test_a_difference_is_found(self):
        page = text_of('README.md')
        for right, wrong in (('`.step()`', '`.stride()`'), ('overrides=None, method=None', 'overrides={}, method=None'), ('`.time_s`', 'nothing')):
            self.assertIn(right, page)
            self.assertNotEqual(page_members(page.replace(right, wrong)), module_members())

    def test_everything_says_what_it_does(self):
        for name in soft_robot_lab.__all__:
            one = getattr(soft_robot_lab, name)
            self.assertTrue(one.__doc__, name)
            for member in module_members().get(name, {}):
                if member != name:
                    self.assertTrue(getattr(one, member).__doc__, '%s.%s' % (name, member))


if __name__ == '__main__':
    unittest.main()
