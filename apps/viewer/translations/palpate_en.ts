<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="en">
<context>
    <name>Streaming</name>
    <message numerus="yes">
        <source>The hand waits: %n brick(s) round it are being read</source>
        <translation>
            <numerusform>The hand waits: %n brick round it is being read</numerusform>
            <numerusform>The hand waits: %n bricks round it are being read</numerusform>
        </translation>
    </message>
</context>
<context>
    <name>palpate::viewer::BrushControls</name>
    <message numerus="yes">
        <source>%n steps</source>
        <translation>
            <numerusform>%n step</numerusform>
            <numerusform>%n steps</numerusform>
        </translation>
    </message>
</context>
<context>
    <name>palpate::viewer::LoopView</name>
    <message numerus="yes">
        <source>%n forces cancelled</source>
        <translation>
            <numerusform>%n force cancelled</numerusform>
            <numerusform>%n forces cancelled</numerusform>
        </translation>
    </message>
    <message numerus="yes">
        <source>%n not recorded</source>
        <translation>
            <numerusform>%n not recorded</numerusform>
            <numerusform>%n not recorded</numerusform>
        </translation>
    </message>
</context>
<context>
    <name>palpate::viewer::MainWindow</name>
    <message numerus="yes">
        <source>%n files were dropped: drop one, or the folder of slices</source>
        <translation>
            <numerusform>%n file was dropped: drop one, or the folder of slices</numerusform>
            <numerusform>%n files were dropped: drop one, or the folder of slices</numerusform>
        </translation>
    </message>
</context>
<context>
    <name>palpate::viewer::RecordingController</name>
    <message numerus="yes">
        <source>%n ticks come out otherwise than they were recorded</source>
        <translation>
            <numerusform>%n tick comes out otherwise than it was recorded</numerusform>
            <numerusform>%n ticks come out otherwise than they were recorded</numerusform>
        </translation>
    </message>
</context>
<context>
    <name>palpate::viewer::SaveController</name>
    <message numerus="yes">
        <source>Saved %1, %2 triangles</source>
        <translation>
            <numerusform>Saved %1, %2 triangle</numerusform>
            <numerusform>Saved %1, %2 triangles</numerusform>
        </translation>
    </message>
</context>
<context>
    <name>palpate::viewer::SessionBar</name>
    <message numerus="yes">
        <source>%n points of the tool hold, torque %1 N mm</source>
        <translation>
            <numerusform>%n point of the tool holds, torque %1 N mm</numerusform>
            <numerusform>%n points of the tool hold, torque %1 N mm</numerusform>
        </translation>
    </message>
</context>
<context>
    <name>palpate::viewer::ToolControls</name>
    <message numerus="yes">
        <source>%n points, %1 mm apart.</source>
        <translation>
            <numerusform>%n point, %1 mm apart.</numerusform>
            <numerusform>%n points, %1 mm apart.</numerusform>
        </translation>
    </message>
    <message numerus="yes">
        <source>%n points.</source>
        <translation>
            <numerusform>%n point.</numerusform>
            <numerusform>%n points.</numerusform>
        </translation>
    </message>
</context>
</TS>
