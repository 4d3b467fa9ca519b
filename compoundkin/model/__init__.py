"""What a user writes: links, pairs, drivers with laws, loads, outlines, profiles; the mechanism, and its validation.

`pairs/`, `loads/`, `laws/` and `profiles/` hold one file a kind and a registry in their `__init__`; those of pairs and
loads import the file of a kind when it is first asked for. A kind is a frozen dataclass that declares each field once,
with its key in files and its text (`fields`): the constructor, readers, writers, the schema and the checks of names
follow from it. Optional answers of pairs are asked for by functions such as `as_drivable` (`pairs/contract`), never by
`isinstance` elsewhere. The attribute catalogue (`attributes`) is here because validation and files need its words
before anything is solved.
"""
